#include "tasks/schedule/schedule_chooser.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::tasks {

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
    elapsed_ += pace.seconds;
    since_check_ += pace.seconds;
    if (candidates_.size() == 1) return false;
    if (trying_) {
        tried(pace);
    } else {
        worked(pace);
    }
    return now_ != before;
}

/// All that trials have cost and, at worst, one more turn.
bool ScheduleChooser::affordable() const noexcept { return lost_ + options_.turn <= options_.max_trial_share * elapsed_; }

bool ScheduleChooser::due(const Pace& pace) noexcept {
    if (reference_ == 0.0) reference_ = pace.per_cycle;
    if (!touching_) touching_ = pace.touching;
    const double change = pace.per_cycle / reference_;
    drifting_ = change > options_.drift || change * options_.drift < 1.0 ? drifting_ + 1 : 0;
    const bool other_links = std::abs(pace.touching - *touching_) > options_.changed_links * std::max(1, *touching_);
    return checks_ == 0 || drifting_ >= 2 || other_links || since_check_ >= period_;
}

void ScheduleChooser::worked(const Pace& pace) noexcept {
    work_ = pace.per_cycle;
    const bool requested = due(pace);
    if (!checking_ && requested && affordable()) {
        touching_ = pace.touching;
        begin_check();
    } else if (checking_ && affordable()) {
        next_turn();
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
    trying_ = affordable();
    now_ = trying_ ? next_ : chosen_;
}

void ScheduleChooser::tried(const Pace& pace) noexcept {
    Candidate& own = candidates_[static_cast<std::size_t>(now_)];
    own.turns.push_back(pace.per_cycle);
    // Against the pace of work, in which neighbours' interference is already; the chosen one's own turns are work.
    if (now_ != chosen_) lost_ += pace.seconds * std::max(0.0, 1.0 - work_ / pace.per_cycle);
    own.out = now_ != 0 && pace.per_cycle > options_.abandon_factor * work_;
    ++next_;
    next_turn();
}

void ScheduleChooser::end_check() noexcept {
    for (Candidate& each : candidates_) {
        const auto middle = each.turns.begin() + static_cast<std::ptrdiff_t>(each.turns.size() / 2);
        std::nth_element(each.turns.begin(), middle, each.turns.end());
        each.median = *middle;  // each has had a turn: none is out before its first
    }
    const int before = chosen_;
    choose();
    ++checks_;
    changes_ += chosen_ != before;
    period_ = chosen_ != before ? options_.first_period : std::min(2.0 * period_, options_.longest_period);
    trying_ = checking_ = false;
    now_ = chosen_;
    reference_ = since_check_ = 0.0;
    drifting_ = 0;
}

/// Speed-up that a candidate must have over another one with as many threads or fewer to replace it [1].
double ScheduleChooser::lead(int candidate, int other) const noexcept {
    if (threads(candidate) > threads(other)) return threads(candidate) > threads(chosen_) ? options_.gain : options_.min_lead;
    if (candidate == chosen_) return 1.0 / options_.min_lead;
    return other == chosen_ ? options_.min_lead : 1.0;
}

/// From the fewest threads on, more are taken only where they pay.
void ScheduleChooser::choose() noexcept {
    int best = 0;
    for (const int each : by_threads_) {
        if (per_cycle(each) * lead(each, best) < per_cycle(best)) best = each;
    }
    chosen_ = best;
}

}  // namespace cvtflow::tasks
