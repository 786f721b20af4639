#include "bench/study/profile/busy_neighbours.hpp"

#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "engine/thread/worker_threads.hpp"

namespace cvtflow::bench {

namespace {

[[noreturn]] void too_few_threads(int requested) {
    throw std::runtime_error("a measurement requires " + std::to_string(requested) + " threads, which are not available");
}

}  // namespace

struct BusyNeighbours::Threads {
    std::vector<std::jthread> all;
};

BusyNeighbours::BusyNeighbours(int count) : threads_(std::make_unique<Threads>()) {
    if (engine::startable_threads(count) < count) too_few_threads(count);
    for (int i = 0; i < count; ++i) {
        threads_->all.emplace_back([](const std::stop_token& stop) {
            while (!stop.stop_requested()) {}
        });
    }
}

BusyNeighbours::~BusyNeighbours() {
    for (std::jthread& thread : threads_->all) thread.request_stop();  // all at once, then each is joined
}

double BusyNeighbours::processor_seconds() const noexcept {
    double sum = 0.0;
    for (std::jthread& thread : threads_->all) {
        clockid_t clock{};
        timespec time{};
        if (pthread_getcpuclockid(thread.native_handle(), &clock) != 0 || clock_gettime(clock, &time) != 0) continue;
        sum += static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
    }
    return sum;
}

namespace {

constexpr long batch = 64;

struct alignas(128) Counter {
    std::atomic<long> value{0};
};

}  // namespace

double bare_barrier_cycle(int threads, double seconds) {
    using Clock = std::chrono::steady_clock;
    if (engine::startable_threads(threads - 1) < threads - 1) too_few_threads(threads);  // those that begin would wait for the others
    Counter opened;                                                                      // number of the open cycle; negative: leave
    std::vector<Counter> answered(static_cast<std::size_t>(std::max(0, threads - 1)));
    std::vector<std::jthread> others;
    for (Counter& own : answered) {
        others.emplace_back([&opened, &own] {
            for (long cycle = 1;; ++cycle) {
                long now = 0;
                while ((now = opened.value.load(std::memory_order_acquire)) >= 0 && now < cycle) {}
                if (now < 0) return;
                own.value.store(cycle, std::memory_order_release);
            }
        });
    }
    std::vector<double> times;
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    for (long cycle = 1; times.empty() || Clock::now() < end;) {
        const auto begin = Clock::now();
        for (const long last = cycle + batch; cycle < last; ++cycle) {
            opened.value.store(cycle, std::memory_order_release);
            for (const Counter& other : answered) {
                while (other.value.load(std::memory_order_acquire) < cycle) {}
            }
        }
        times.push_back(std::chrono::duration<double>(Clock::now() - begin).count() / batch);
    }
    opened.value.store(-1, std::memory_order_release);
    std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
    return times[times.size() / 2];
}

}  // namespace cvtflow::bench
