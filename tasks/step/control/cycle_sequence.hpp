#pragma once
/// A coroutine that yields cycles of the task graph: serial code between cycles reads from top to bottom although an executor calls it.

#include <coroutine>
#include <cstddef>
#include <exception>
#include <utility>

#include "engine/executor/executor.hpp"
#include "tasks/step/control/frame_memory.hpp"

namespace cvtflow::tasks {

/// Suspended at its start and after each `co_yield cycle`. Its frame is in the FrameMemory of the object whose member the coroutine is.
class CycleSequence {
public:
    struct promise_type {
        int cycle = engine::Controller::stop;
        std::exception_ptr thrown;

        template <class Owner, class... Arguments>
        static void* operator new(std::size_t bytes, Owner& owner, Arguments&...) {
            return FrameMemory::take(bytes, owner.frame_memory());
        }
        static void operator delete(void* frame) noexcept { FrameMemory::give_back(frame); }
        CycleSequence get_return_object() noexcept { return CycleSequence(std::coroutine_handle<promise_type>::from_promise(*this)); }
        static std::suspend_always initial_suspend() noexcept { return {}; }
        static std::suspend_always final_suspend() noexcept { return {}; }
        std::suspend_always yield_value(int next) noexcept {
            cycle = next;
            return {};
        }
        void return_void() noexcept {}
        void unhandled_exception() noexcept { thrown = std::current_exception(); }
    };

    CycleSequence(CycleSequence&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
    CycleSequence(const CycleSequence&) = delete;
    CycleSequence& operator=(const CycleSequence&) = delete;
    CycleSequence& operator=(CycleSequence&&) = delete;
    ~CycleSequence() {
        if (handle_) handle_.destroy();
    }

    /// Runs up to the next cycle and returns it; Controller::stop once the coroutine has returned or thrown.
    [[nodiscard]] int next() noexcept {
        if (!handle_.done()) handle_.resume();
        return handle_.done() ? engine::Controller::stop : handle_.promise().cycle;
    }
    /// Rethrows the exception that ended the coroutine, if any.
    void rethrow() const {
        if (handle_.promise().thrown) std::rethrow_exception(handle_.promise().thrown);
    }

private:
    explicit CycleSequence(std::coroutine_handle<promise_type> handle) noexcept : handle_(handle) {}

    std::coroutine_handle<promise_type> handle_;
};

}  // namespace cvtflow::tasks
