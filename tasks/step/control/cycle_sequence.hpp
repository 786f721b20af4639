#pragma once
/// A coroutine that yields cycles of the task graph: serial code between cycles reads from top to bottom although an executor calls it.
/// The integration is one, and each step of a method another.

#include <coroutine>
#include <cstddef>
#include <exception>
#include <memory>
#include <new>
#include <utility>

#include "engine/executor/executor.hpp"
#include "tasks/step/fault.hpp"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"  // without optimisation: promise_type's new has an owner, its delete needs none
#endif

namespace cvtflow::tasks {

/// Memory of one coroutine's frame, kept for the next one: runs of a simulation and steps of a method follow each other, and only the first
/// allocates. A second one at the same time is allocated separately. Outlives the coroutines in it.
class FrameMemory {
public:
    FrameMemory() = default;
    /// Allocates room for a frame [B].
    explicit FrameMemory(std::size_t bytes) : memory_(static_cast<std::byte*>(::operator new(bytes))), bytes_(bytes) {}

    [[nodiscard]] static void* take(std::size_t bytes, FrameMemory* kept) {
        if (kept != nullptr && kept->taken_) kept = nullptr;
        const std::size_t needed = bytes + sizeof(Head);
        if (kept != nullptr && kept->bytes_ < needed) {
            kept->memory_.reset(static_cast<std::byte*>(::operator new(needed)));
            kept->bytes_ = needed;
        }
        if (kept != nullptr) kept->taken_ = true;
        return new (kept != nullptr ? kept->memory_.get() : ::operator new(needed)) Head{kept} + 1;
    }
    static void give_back(void* frame) noexcept {
        Head* head = static_cast<Head*>(frame) - 1;
        if (FrameMemory* owner = head->owner)
            owner->taken_ = false;
        else
            ::operator delete(head);
    }

private:
    /// Header in front of a frame.
    struct alignas(__STDCPP_DEFAULT_NEW_ALIGNMENT__) Head {
        FrameMemory* owner;  ///< nullptr: allocated separately
    };
    struct Free {
        void operator()(std::byte* memory) const noexcept { ::operator delete(memory); }
    };

    std::unique_ptr<std::byte, Free> memory_;
    std::size_t bytes_ = 0;
    bool taken_ = false;
};

/// Suspended at its start and after each `co_yield cycle`; ends with `co_return fault`, an empty one if all is well. Its frame is in the
/// FrameMemory of the object whose member the coroutine is.
class CycleSequence {
public:
    struct promise_type {
        int cycle = engine::Controller::stop;
        Fault fault;
        std::exception_ptr thrown;

        template <class Owner, class... Arguments>
        static void* operator new(std::size_t bytes, Owner& owner, Arguments&...) {
            return FrameMemory::take(bytes, owner.frame_memory());
        }
        static void operator delete(void* frame) noexcept { FrameMemory::give_back(frame); }  // NOLINT: its operator new is the template
        CycleSequence get_return_object() noexcept { return CycleSequence(std::coroutine_handle<promise_type>::from_promise(*this)); }
        static std::suspend_always initial_suspend() noexcept { return {}; }
        static std::suspend_always final_suspend() noexcept { return {}; }
        std::suspend_always yield_value(int next) noexcept {
            cycle = next;
            return {};
        }
        void return_value(const Fault& end) noexcept { fault = end; }
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
    /// Fault that ended the coroutine; empty: none.
    [[nodiscard]] const Fault& fault() const noexcept { return handle_.promise().fault; }
    /// Rethrows the exception that ended the coroutine, if any.
    void rethrow() const {
        if (handle_.promise().thrown) std::rethrow_exception(handle_.promise().thrown);
    }

private:
    explicit CycleSequence(std::coroutine_handle<promise_type> handle) noexcept : handle_(handle) {}

    std::coroutine_handle<promise_type> handle_;
};

}  // namespace cvtflow::tasks
