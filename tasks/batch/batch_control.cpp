#include <algorithm>

#include "tasks/batch/case_engine.hpp"

namespace cvtflow::tasks {

double BatchControl::grace_left() {
    return gate_.through([&] {
        if (asked_ == std::chrono::steady_clock::time_point{}) asked_ = std::chrono::steady_clock::now();
        return grace_ - std::chrono::duration<double>(std::chrono::steady_clock::now() - asked_).count();
    });
}

void BatchControl::idle() {
    gate_.through([&] { ++idle_; });
    tail_.request();
}

int BatchControl::threads_per_case() {
    if (!tail_.requested()) return 1;
    return gate_.through([&] { return threads_ / std::max(1, threads_ - idle_); });
}

void BatchControl::tell(const std::string& what) {
    gate_.through([&] {
        if (notice_) notice_(what);
    });
}

}  // namespace cvtflow::tasks
