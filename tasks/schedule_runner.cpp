#include "tasks/schedule_runner.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cvtflow::tasks {

namespace {

/// Growth of the imbalance from which on borders are moved: a move costs an end and a beginning of the threads' common run.
constexpr double tolerable_growth = 1.02;

[[nodiscard]] bool touches(const Workspace& w, int link) noexcept {
    const model::Phase* tips = w.phases.data() + model::tips_per_link * link;
    return std::any_of(tips, tips + model::tips_per_link, [](model::Phase phase) { return phase != model::Phase::free; });
}

[[nodiscard]] int touching_links(const Workspace& w) noexcept {
    int count = 0;
    for (int link = 0; link < w.layout().links; ++link) count += touches(w, link);
    return count;
}

[[nodiscard]] std::string times(long count, const char* what) { return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s"); }

}  // namespace

ScheduleRunner::ScheduleRunner(Workspace& workspace, std::vector<Schedule> candidates, const ChooserOptions& options, engine::StampRecorder* recorder)
    : w_(workspace), chooser_(static_cast<int>(candidates.size()), options), recorder_(recorder) {
    for (Schedule& each : candidates) slots_.push_back({each, Partition::equal(w_.layout().links, each.segments)});
    Slot& first = slots_.front();
    first.executor = make_executor(first.schedule, recorder_);   // complaints come now
    w_.repartition(first.partition);
    first.graph = step_graph(w_, first.schedule.assembly);
}

void ScheduleRunner::run(StepController& controller) {
    take_up();
    if (slots_.size() == 1 && (!schedule().balanced || schedule().segments == 1)) return slots_.front().executor->run(graph(), &w_, controller);
    RestingController resting(controller, *this);
    for (;;) {
        slots_[current()].executor->run(graph(), &w_, resting);
        if (resting.over()) return;
        ++rests_;
        take_up();
    }
}

/// Brings workspace, graph and executor of the candidate at hand together.
void ScheduleRunner::take_up() {
    Slot& slot = slots_[current()];
    if (!slot.executor) slot.executor = make_executor(slot.schedule, recorder_);
    bool stale = slot.graph.size() == 0;
    if (slot.schedule.balanced && slot.schedule.segments > 1) {
        Partition moved = balanced_partition(w_.phases, w_.layout().links, slot.schedule.segments);
        if (!std::ranges::equal(moved.segments(), slot.partition.segments())) {
            slot.partition = std::move(moved);
            stale = true;
            moves_ += rests_ > 0;
        }
    }
    w_.repartition(slot.partition);
    if (stale) slot.graph = step_graph(w_, slot.schedule.assembly);
    balanced_at_ = imbalance();
}

/// Cost of the most costly segment over the mean, as links are now.
double ScheduleRunner::imbalance() const noexcept {
    const LinkCosts costs;
    double longest = 0.0, all = 0.0;
    for (const Segment& segment : w_.partition.segments()) {
        double cost = 0.0;
        for (int link = segment.first; link < segment.last; ++link) cost += touches(w_, link) ? costs.touching : costs.free;
        longest = std::max(longest, cost);
        all += cost;
    }
    return longest * w_.partition.size() / all;
}

bool ScheduleRunner::rest(double seconds, double per_cycle) noexcept {
    const bool other = chooser_.took({seconds, per_cycle, touching_links(w_)});
    return other || (schedule().balanced && imbalance() > tolerable_growth * balanced_at_);
}

std::string ScheduleRunner::text() const {
    const std::size_t chosen = static_cast<std::size_t>(chooser_.chosen());
    const std::string moved = moves_ > 0 ? fmt::format("borders moved {}", times(moves_, "time")) : "";
    const std::string name = slots_[chosen].schedule.text();
    if (slots_.size() == 1) return moved.empty() ? name : fmt::format("{} ({})", name, moved);
    if (chooser_.checks() == 0) return name + " (auto: too short a run for trials)";
    std::size_t other = chosen == 0 ? 1 : 0;   // serial, or the best beside it
    for (std::size_t each = 2; chosen == 0 && each < slots_.size(); ++each) {
        if (chooser_.per_cycle(static_cast<int>(each)) < chooser_.per_cycle(static_cast<int>(other))) other = each;
    }
    return fmt::format("{} (auto: {:.1f} us per cycle, {} {:.1f} us; {}, {}{})", name, 1e6 * chooser_.per_cycle(chooser_.chosen()),
                       slots_[other].schedule.text(), 1e6 * chooser_.per_cycle(static_cast<int>(other)), times(chooser_.checks(), "check"),
                       times(chooser_.changes(), "change"), moved.empty() ? "" : ", " + moved);
}

}  // namespace cvtflow::tasks
