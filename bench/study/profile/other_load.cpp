#include "bench/study/profile/other_load.hpp"

#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <latch>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "engine/thread/worker_threads.hpp"

namespace cvtflow::bench {

namespace {

using PieceClock = std::chrono::steady_clock;

/// Work of a thread.
struct alignas(128) Pieces {
    long count = 0;
    double least = 1e9;  ///< time of the quickest piece [s]
    double value = 1.0;
};

/// Arithmetic that depends on itself (about 10 us): neither wider vectors nor a sibling on the same core change its time much.
void piece(Pieces& mine) noexcept {
    double x = mine.value;
    for (int i = 0; i < 3000; ++i) x = x * 0.999999 + 1e-6;
    mine.value = x;
}

void count_pieces(Pieces& mine, PieceClock::time_point end) noexcept {
    for (auto begin = PieceClock::now(); begin < end;) {
        piece(mine);
        const auto now = PieceClock::now();
        mine.least = std::min(mine.least, std::chrono::duration<double>(now - begin).count());
        ++mine.count;
        begin = now;
    }
}

}  // namespace

double processors_got(int threads, double seconds) {
    if (engine::startable_threads(threads - 1) < threads - 1)
        throw std::runtime_error("a calibration requires " + std::to_string(threads) + " threads, which are not available");
    std::vector<Pieces> all(static_cast<std::size_t>(threads));
    const auto begin = PieceClock::now();
    const auto end = begin + std::chrono::duration_cast<PieceClock::duration>(std::chrono::duration<double>(seconds));
    {
        std::vector<std::jthread> others;
        for (std::size_t thread = 1; thread < all.size(); ++thread) others.emplace_back([&, thread] { count_pieces(all[thread], end); });
        count_pieces(all.front(), end);
    }
    const double passed = std::max(seconds, std::chrono::duration<double>(PieceClock::now() - begin).count());
    double least = 1e9;
    long count = 0;
    for (const Pieces& mine : all) {
        least = std::min(least, mine.least);
        count += mine.count;
    }
    return std::min(static_cast<double>(threads), static_cast<double>(count) * least / passed);
}

void too_few_threads(int requested) {
    throw std::runtime_error("a measurement requires " + std::to_string(requested) + " threads, which are not available");
}

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

}  // namespace cvtflow::bench
