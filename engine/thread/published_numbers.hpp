#pragma once
/// Numbers that one thread replaces and others read, all of one moment: a sequence lock. The writer never waits.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cvtflow::engine {

class PublishedNumbers {
public:
    explicit PublishedNumbers(std::size_t size) : numbers_(size) {}

    [[nodiscard]] std::size_t size() const noexcept { return numbers_.size(); }

    /// Replaces the numbers. Called by one thread at a time. @param numbers [size()]
    void publish(std::span<const double> numbers) noexcept {
        const std::uint64_t before = version_.load(std::memory_order_relaxed);
        version_.store(before + 1, std::memory_order_relaxed);
        std::atomic_thread_fence(std::memory_order_release);
        for (std::size_t k = 0; k < size(); ++k) numbers_[k].store(numbers[k], std::memory_order_relaxed);
        version_.store(before + 2, std::memory_order_release);
    }

    /// Reads all numbers of one moment; begins again if they were replaced meanwhile. Called by any number of threads. @param out [size()]
    void read(std::span<double> out) const noexcept {
        for (;;) {
            const std::uint64_t before = version_.load(std::memory_order_acquire);
            for (std::size_t k = 0; k < size(); ++k) out[k] = numbers_[k].load(std::memory_order_relaxed);
            std::atomic_thread_fence(std::memory_order_acquire);
            if (before % 2 == 0 && version_.load(std::memory_order_relaxed) == before) return;
        }
    }

private:
    std::vector<std::atomic<double>> numbers_;
    std::atomic<std::uint64_t> version_{0};  ///< odd while numbers are replaced
};

}  // namespace cvtflow::engine
