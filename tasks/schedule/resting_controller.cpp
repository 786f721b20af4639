#include "tasks/schedule/resting_controller.hpp"

#include <utility>

namespace cvtflow::tasks {

int RestingController::next() noexcept {
    if (held_ != stop) {
        taken_up_ = Clock::now();
        looks_ = 0;
        return std::exchange(held_, stop);
    }
    const int cycle = whole_.next();
    over_ = cycle == stop;
    ++cycles_;
    const long steps = whole_.counters().steps;
    if (over_ || steps == steps_) return cycle;
    steps_ = steps;
    if (steps % stride != 0 || !rests()) return cycle;
    held_ = cycle;
    return stop;
}

bool RestingController::rests() noexcept {
    const auto now = Clock::now();
    const auto since = [now](Clock::time_point then) { return std::chrono::duration<double>(now - then).count(); };
    if (looks_++ == 0) {
        counted_ = now;
        cycles_ = 0;
        return false;
    }
    if (since(taken_up_) < judge_.window()) return false;
    const bool rests = judge_.rest(since(taken_up_), since(counted_) / static_cast<double>(cycles_));
    taken_up_ = counted_ = now;
    cycles_ = 0;
    return rests;
}

}  // namespace cvtflow::tasks
