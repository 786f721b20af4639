#include "bench/study/profile/bare_barrier.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <limits>
#include <thread>
#include <vector>

#include "engine/thread/backoff.hpp"

namespace cvtflow::bench {

namespace {

using Clock = std::chrono::steady_clock;

constexpr long batch = 64;

struct alignas(engine::apart) Cycle {
    std::atomic<long> number{0};
};

/// Answers each cycle that is opened, until a negative number is.
void answer_cycles(const std::atomic<long>& opened, std::atomic<long>& answer) noexcept {
    for (long cycle = 1;; ++cycle) {
        long now = 0;
        while ((now = opened.load(std::memory_order_acquire)) >= 0 && now < cycle) {}
        if (now < 0) return;
        answer.store(cycle, std::memory_order_release);
    }
}

/// Threads that answer cycles leave at the end of its life.
struct Leaving {
    std::atomic<long>& opened;
    ~Leaving() { opened.store(-1, std::memory_order_release); }
};

/// @return whether it has reached the cycle within the longest wait
[[nodiscard]] bool reaches(const std::atomic<long>& other, long cycle, std::chrono::duration<double> longest_wait) noexcept {
    const auto polled = [&]() noexcept {
        constexpr int polls = 4096;  // without a reading of the clock, which would disturb what is measured
        for (int poll = 0; poll < polls; ++poll) {
            if (other.load(std::memory_order_acquire) >= cycle) return true;
        }
        return false;
    };
    if (polled()) return true;
    const auto begin = Clock::now();
    while (!polled()) {
        if (Clock::now() - begin >= longest_wait) return false;
    }
    return true;
}

}  // namespace

double bare_barrier_cycle(int threads, double seconds, double longest_wait) noexcept try {
    Cycle opened;
    std::vector<Cycle> answered(static_cast<std::size_t>(std::max(0, threads - 1)));
    std::vector<double> times;
    std::vector<std::jthread> others;
    const Leaving at_the_end{opened.number};
    for (Cycle& slot : answered) others.emplace_back([&opened, &slot] { answer_cycles(opened.number, slot.number); });
    const auto meet = [&](long cycle) {
        opened.number.store(cycle, std::memory_order_release);
        return std::ranges::all_of(
            answered, [&](const Cycle& other) { return reaches(other.number, cycle, std::chrono::duration<double>(longest_wait)); });
    };
    long cycle = 1;
    bool meeting = meet(cycle);  // all have begun
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    while (meeting && (times.empty() || Clock::now() < end)) {
        const auto begin = Clock::now();
        for (const long last = cycle + batch; meeting && cycle < last;) meeting = meet(++cycle);
        times.push_back(std::chrono::duration<double>(Clock::now() - begin).count() / batch);
    }
    if (!meeting) return std::numeric_limits<double>::infinity();
    const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
    std::ranges::nth_element(times, middle);
    return *middle;
} catch (const std::exception&) {
    return std::numeric_limits<double>::infinity();  // no memory, or too few threads; those that began have left
}

}  // namespace cvtflow::bench
