#include "tasks/schedule/schedule_chooser.hpp"

#include <algorithm>

namespace cvtflow::tasks {

ScheduleChooser::ScheduleChooser(int candidates, const ChooserOptions& options)
    : options_(options),
      paces_(static_cast<std::size_t>(candidates)),
      trying_(candidates > 1),
      period_(options.first_period),
      soonest_(10.0 * options.window * candidates) {}

bool ScheduleChooser::record(const Pace& pace) noexcept {
    const int before = now_;
    if (paces_.size() == 1) return false;
    if (trying_) {
        paces_[static_cast<std::size_t>(now_)] = pace.per_cycle;
        if (++now_ == static_cast<int>(paces_.size())) end_turns();
        return now_ != before;
    }
    since_ += pace.seconds;
    const double ratio = pace.per_cycle / per_cycle(chosen_);
    drifting_ = ratio > options_.change || ratio * options_.change < 1.0 ? drifting_ + 1 : 0;
    trying_ = since_ >= soonest_ && (drifting_ >= 2 || since_ >= period_);
    if (trying_) now_ = 0;
    return now_ != before;
}

void ScheduleChooser::end_turns() noexcept {
    int best = 0;
    for (int each = 1; each < now_; ++each) {
        if (per_cycle(each) * options_.gain < per_cycle(best)) best = each;
    }
    const bool changes = best != chosen_;
    period_ = checks_ == 0 || changes ? options_.first_period : std::min(2.0 * period_, options_.longest_period);
    ++checks_;
    changes_ += changes;
    chosen_ = now_ = best;
    trying_ = false;
    drifting_ = 0;
    since_ = 0.0;
}

}  // namespace cvtflow::tasks
