#include "bench/study/profile/busy_neighbours.hpp"

#include <pthread.h>

#include <ctime>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "engine/thread/worker_threads.hpp"

namespace cvtflow::bench {

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
