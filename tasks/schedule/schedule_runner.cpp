#include "tasks/schedule/schedule_runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

/// Passes the step controller's decisions on. At the end of every fourth step it reads the clock, and at the end of a window it calls
/// should_pause(). To pause, it holds back the next step's first cycle and returns stop; the next Executor::run() begins with that cycle.
/// The step controller prepares that cycle in the workspace, independently of segments, so results are bitwise those of an unbroken run.
class ScheduleRunner::PausingController final : public engine::Controller {
public:
    PausingController(StepController& whole, ScheduleRunner& runner) : whole_(whole), runner_(runner) {}

    [[nodiscard]] int next() noexcept override;
    /// Whether the step controller has returned stop: the run is complete.
    [[nodiscard]] bool over() const noexcept { return over_; }

private:
    using Clock = std::chrono::steady_clock;
    static constexpr int stride = 4;  ///< steps between readings of the clock; the first stride is not counted because threads start then

    [[nodiscard]] bool pauses() noexcept;

    StepController& whole_;
    ScheduleRunner& runner_;
    bool over_ = false;
    int held_ = stop;                ///< cycle kept back
    long steps_ = 0, readings_ = 0;  ///< steps seen; readings of the clock since the run was taken up
    long cycles_ = 0;                ///< cycles since `counted_`
    Clock::time_point taken_up_ = Clock::now(), counted_ = taken_up_;
};

int ScheduleRunner::PausingController::next() noexcept {
    if (held_ != stop) {
        taken_up_ = Clock::now();
        readings_ = 0;
        return std::exchange(held_, stop);
    }
    const int cycle = whole_.next();
    over_ = cycle == stop;
    ++cycles_;
    const long steps = whole_.counters().steps;
    if (over_ || steps == steps_) return cycle;
    steps_ = steps;
    if (steps % stride != 0 || !pauses()) return cycle;
    held_ = cycle;
    return stop;
}

bool ScheduleRunner::PausingController::pauses() noexcept {
    const auto now = Clock::now();
    const auto since = [now](Clock::time_point then) { return std::chrono::duration<double>(now - then).count(); };
    if (readings_++ == 0) {
        counted_ = now;
        cycles_ = 0;
        return false;
    }
    if (since(taken_up_) < runner_.chooser_.window()) return false;
    const bool pauses = runner_.should_pause(since(taken_up_), since(counted_) / static_cast<double>(cycles_));
    taken_up_ = counted_ = now;
    cycles_ = 0;
    return pauses;
}

namespace {

/// Segments are repartitioned if the longest one exceeds that of balanced borders by this factor: a repartition costs an end and a
/// beginning of the threads' common run.
constexpr double tolerable = 1.02;

[[nodiscard]] int grain(const Workspace& w) noexcept { return Partition::grain(model::lanes_of(w.variator.chain().isa())); }

[[nodiscard]] std::vector<int> equal_cuts(const Workspace& w, int segments) {
    const Partition partition = Partition::equal(w.layout().links, segments, grain(w));
    std::vector<int> cuts{0};
    for (const Segment& segment : partition.segments()) cuts.push_back(segment.last);
    return cuts;
}

[[nodiscard]] bool is_cut_at(const Partition& partition, const std::vector<int>& cuts) noexcept {
    if (cuts.size() != static_cast<std::size_t>(partition.size()) + 1) return false;
    for (int s = 0; s < partition.size(); ++s) {
        if (partition[s] != Segment{cuts[static_cast<std::size_t>(s)], cuts[static_cast<std::size_t>(s) + 1]}) return false;
    }
    return true;
}

[[nodiscard]] std::string times(long count, const char* what) { return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s"); }

}  // namespace

ScheduleRunner::ScheduleRunner(Workspace& workspace, StepMethod& method, std::vector<Schedule> candidates, const ChooserOptions& options,
                               engine::StampRecorder* recorder)
    : w_(workspace), method_(&method), chooser_(static_cast<int>(candidates.size()), options), recorder_(recorder) {
    costs_.grain = grain(w_);
    for (Schedule& each : candidates) slots_.push_back({each, equal_cuts(w_, each.segments)});
    cuts_.reserve(static_cast<std::size_t>(w_.layout().links) + 1);
    Slot& first = slots_.front();
    first.executor = make_executor(first.schedule, recorder_);  // complaints come now
    cut_at(first.cuts);
    w_.sums_missing = first.schedule.assembly.kind == Assembly::staged;
    first.graph = step_graph(w_, first.schedule.assembly, method_);
}

void ScheduleRunner::cut_at(const std::vector<int>& cuts) {
    w_.repartition(Partition::at(cuts));
    method_->repartitioned();
}

void ScheduleRunner::take_method(StepMethod& method) noexcept {
    method_ = &method;
    for (Slot& slot : slots_) slot.graph = {};
}

void ScheduleRunner::run(StepController& controller) {
    take_up();
    if (slots_.size() == 1 && (!schedule().balanced || schedule().segments == 1))
        return slots_.front().executor->run(graph(), &w_, controller);
    PausingController resting(controller, *this);
    for (;;) {
        slots_[current()].executor->run(graph(), &w_, resting);
        if (resting.over()) return;
        ++pauses_;
        take_up();
    }
}

void ScheduleRunner::release_threads() const noexcept {
    for (const Slot& slot : slots_) {
        if (slot.executor) slot.executor->release_threads();
    }
}

/// Connects workspace, graph and executor of the present candidate.
void ScheduleRunner::take_up() {
    Slot& slot = slots_[current()];
    if (!slot.executor) slot.executor = make_executor(slot.schedule, recorder_);
    bool stale = slot.graph.size() == 0;
    if (needs_repartition() || (stale && slot.schedule.balanced)) {
        repartitions_ += pauses_ > 0 && !stale;
        cuts_.resize(slot.cuts.size());
        balance(w_.tips.phases, cuts_, costs_);
        slot.cuts = cuts_;
        stale = true;
    }
    if (stale || !is_cut_at(w_.partition, slot.cuts)) cut_at(slot.cuts);
    w_.sums_missing = slot.schedule.assembly.kind == Assembly::staged;
    if (stale) slot.graph = step_graph(w_, slot.schedule.assembly, method_);
}

bool ScheduleRunner::needs_repartition() noexcept {
    const Slot& slot = slots_[current()];
    if (!slot.schedule.balanced || slot.schedule.segments == 1) return false;
    cuts_.resize(slot.cuts.size());  // within what was reserved
    balance(w_.tips.phases, cuts_, costs_);
    return longest_segment(w_.tips.phases, slot.cuts, costs_) > tolerable * longest_segment(w_.tips.phases, cuts_, costs_);
}

bool ScheduleRunner::should_pause(double seconds, double per_cycle) noexcept {
    const bool other = chooser_.record({seconds, per_cycle});
    return other || needs_repartition();
}

std::string ScheduleRunner::text() const {
    const std::size_t chosen = static_cast<std::size_t>(chooser_.chosen());
    const std::string moved = repartitions_ > 0 ? fmt::format("borders moved {}", times(repartitions_, "time")) : "";
    const std::string name = slots_[chosen].schedule.text();
    if (slots_.size() == 1) return moved.empty() ? name : fmt::format("{} ({})", name, moved);
    if (chooser_.checks() == 0) return name + " (auto; the run was too short to try others)";
    const auto pace = [this](std::size_t each) { return chooser_.per_cycle(static_cast<int>(each)); };
    std::size_t other = chosen == 0 ? 1 : 0;  // serial, or the best beside it
    for (std::size_t each = 2; chosen == 0 && each < slots_.size(); ++each) {
        if (pace(each) < pace(other)) other = each;
    }
    return fmt::format("{} (auto: {:.1f} us per cycle, {} {:.1f} us; {}, {}{})", name, 1e6 * pace(chosen), slots_[other].schedule.text(),
                       1e6 * pace(other), times(chooser_.checks(), "check"), times(chooser_.changes(), "change"),
                       moved.empty() ? "" : ", " + moved);
}

}  // namespace cvtflow::tasks
