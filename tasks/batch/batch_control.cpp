#include <algorithm>
#include <limits>

#include "tasks/batch/batch.hpp"
#include "tasks/batch/case_engine.hpp"

namespace cvtflow::tasks {

double BatchProgress::left() const noexcept {
    const long open = cases - before - done;
    if (open == 0) return 0.0;
    if (warm == 0 || done < 2 * warm) return std::numeric_limits<double>::quiet_NaN();
    return static_cast<double>(open) * (wall - warm_wall) / static_cast<double>(done - warm);
}

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
