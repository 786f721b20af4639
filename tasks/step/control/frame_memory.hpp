#pragma once
/// Memory in which one coroutine after the other has its frame.

#include <cstddef>
#include <memory>
#include <new>

namespace cvtflow::tasks {

/// Memory of one coroutine's frame, kept for the next one: runs of a simulation follow each other, and only the first allocates. A second
/// one at the same time has memory of its own. Outlives the coroutines in it.
class FrameMemory {
public:
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
    /// In front of a frame.
    struct alignas(__STDCPP_DEFAULT_NEW_ALIGNMENT__) Head {
        FrameMemory* owner;  ///< nullptr: memory of its own
    };
    struct Free {
        void operator()(std::byte* memory) const noexcept { ::operator delete(memory); }
    };

    std::unique_ptr<std::byte, Free> memory_;
    std::size_t bytes_ = 0;
    bool taken_ = false;
};

}  // namespace cvtflow::tasks
