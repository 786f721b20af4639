#include "tasks/schedule/schedule_chooser.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cvtflow::tasks {

/// Counts the loss against the pace of work, which includes interference by neighbours.
void TrialBudget::tried(const Pace& pace, double work) noexcept { lost += pace.seconds * std::max(0.0, 1.0 - work / pace.per_cycle); }

bool PaceWatch::changed(const Pace& pace, const ChooserOptions& options) noexcept {
    if (reference_ == 0.0) reference_ = pace.per_cycle;
    if (!touching_) touching_ = pace.touching;
    const double change = pace.per_cycle / reference_;
    drifting_ = change > options.drift || change * options.drift < 1.0 ? drifting_ + 1 : 0;
    return drifting_ >= 2 || std::abs(pace.touching - *touching_) > options.changed_links * std::max(1, *touching_);
}

void PaceWatch::restart() noexcept {
    reference_ = 0.0;
    drifting_ = 0;
}

ScheduleChooser::ScheduleChooser(std::span<const int> threads, const ChooserOptions& options)
    : options_(options), candidates_(threads.size()), period_(options.first_period) {
    for (std::size_t each = 0; each < threads.size(); ++each) {
        candidates_[each].threads = threads[each];
        candidates_[each].turns.reserve(static_cast<std::size_t>(options.rounds));
        by_threads_.push_back(static_cast<int>(each));
    }
    std::stable_sort(by_threads_.begin(), by_threads_.end(),
                     [threads](int a, int b) { return threads[static_cast<std::size_t>(a)] < threads[static_cast<std::size_t>(b)]; });
}

bool ScheduleChooser::record(const Pace& pace) noexcept {
    const int before = now_;
    budget_.elapsed += pace.seconds;
    since_check_ += pace.seconds;
    asks_ = false;
    if (trying_ && !checking_) {
        tried_early(pace);
    } else if (trying_) {
        tried(pace);
    } else {
        worked(pace);
        asks_ = candidates_.size() > 1 && checks_ == 0 && !checking_ && !tried_early_ && budget_.affords_question(options_);
    }
    return now_ != before || asks_;
}

void ScheduleChooser::answer(double meeting, double seconds) noexcept {
    budget_.elapsed += seconds;
    budget_.lost += seconds;
    if (!std::exchange(asks_, false) || meeting > options_.meeting) return;
    now_ = by_threads_[1];
    trying_ = true;
}

void ScheduleChooser::interrupt() noexcept {
    trying_ = asks_ = false;
    now_ = chosen_;
}

void ScheduleChooser::worked(const Pace& pace) noexcept {
    work_ = pace.per_cycle;
    if (candidates_.size() == 1) return;
    const bool changed = watch_.changed(pace, options_), due = changed || checks_ == 0 || since_check_ >= period_;
    if (!budget_.affords(options_)) return;
    if (checking_) {
        next_turn();
    } else if (due) {
        watch_.checks_at(pace.touching);
        begin_check();
    }
}

void ScheduleChooser::begin_check() noexcept {
    checking_ = true;
    next_ = 0;
    round_ = 0;
    for (Candidate& each : candidates_) {
        each.turns.clear();
        each.out = false;
    }
    next_turn();
}

/// The next candidate, or work if the check cannot continue now.
void ScheduleChooser::next_turn() noexcept {
    const int count = static_cast<int>(candidates_.size());
    for (; round_ < options_.rounds; ++round_, next_ = 0) {
        while (next_ < count && candidates_[static_cast<std::size_t>(next_)].out) ++next_;
        if (next_ < count) break;
    }
    if (round_ == options_.rounds) return end_check();
    trying_ = budget_.affords(options_);
    now_ = trying_ ? next_ : chosen_;
}

/// The early turn, then one of work, since the work before it was the run's first, when caches were cold.
void ScheduleChooser::tried_early(const Pace& pace) noexcept {
    const int early = by_threads_[1];
    if (now_ == early) {
        budget_.tried(pace, work_);
        candidates_[static_cast<std::size_t>(early)].median = pace.per_cycle;
        now_ = chosen_;
        return;
    }
    work_ = std::min(work_, pace.per_cycle);
    candidates_[static_cast<std::size_t>(chosen_)].median = work_;
    tried_early_ = true;
    choose(per_cycle(early) * lead(early, chosen_) < work_ ? early : chosen_);
}

void ScheduleChooser::tried(const Pace& pace) noexcept {
    Candidate& present = candidates_[static_cast<std::size_t>(now_)];
    present.turns.push_back(pace.per_cycle);
    if (now_ != chosen_) budget_.tried(pace, work_);  // turns of the chosen one are work
    present.out = now_ != 0 && pace.per_cycle > options_.abandon_factor * work_;
    ++next_;
    next_turn();
}

void ScheduleChooser::end_check() noexcept {
    for (Candidate& each : candidates_) {
        const auto middle = each.turns.begin() + static_cast<std::ptrdiff_t>(each.turns.size() / 2);
        std::nth_element(each.turns.begin(), middle, each.turns.end());
        each.median = *middle;  // each has had a turn: none is out before its first
    }
    ++checks_;
    since_check_ = 0.0;
    const int candidate = fastest();
    period_ = chosen_ != candidate ? options_.first_period : std::min(2.0 * period_, options_.longest_period);
    choose(candidate);
}

/// Ends trials.
void ScheduleChooser::choose(int candidate) noexcept {
    changes_ += chosen_ != candidate;
    chosen_ = now_ = candidate;
    trying_ = checking_ = false;
    watch_.restart();
}

/// Speed-up that a candidate must have over another one with as many threads or fewer to replace it [1].
double ScheduleChooser::lead(int candidate, int other) const noexcept {
    const auto threads = [this](int each) { return candidates_[static_cast<std::size_t>(each)].threads; };
    if (threads(candidate) > threads(other)) return threads(candidate) > threads(chosen_) ? options_.gain : options_.min_lead;
    if (candidate == chosen_) return 1.0 / options_.min_lead;
    return other == chosen_ ? options_.min_lead : 1.0;
}

/// Fastest candidate, with more threads only where they pay.
int ScheduleChooser::fastest() const noexcept {
    int best = 0;
    for (const int each : by_threads_) {
        if (per_cycle(each) * lead(each, best) < per_cycle(best)) best = each;
    }
    return best;
}

}  // namespace cvtflow::tasks
