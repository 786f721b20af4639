#include <algorithm>

#include "tasks/batch/case_engine.hpp"

namespace cvtflow::tasks {

double BatchControl::grace_left() {
    return mutex_.guard([&] {
        if (asked_ == std::chrono::steady_clock::time_point{}) asked_ = std::chrono::steady_clock::now();
        return grace_ - std::chrono::duration<double>(std::chrono::steady_clock::now() - asked_).count();
    });
}

void BatchControl::idle() {
    mutex_.guard([&] { ++idle_; });
    tail_.request();
}

int BatchControl::threads_per_case() {
    if (!tail_.requested()) return 1;
    return mutex_.guard([&] { return threads_ / std::max(1, threads_ - idle_); });
}

void BatchControl::tell(const std::string& what) {
    mutex_.guard([&] {
        if (notice_) notice_(what);
    });
}

}  // namespace cvtflow::tasks
