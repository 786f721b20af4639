#pragma once
/// Runs steps under a schedule that may change on the way: another of several candidates when the machine's load or the chain's phases
/// change, other borders of segments when links begin or cease to touch.

#include <memory>
#include <string>
#include <vector>

#include "tasks/schedule/schedule.hpp"
#include "tasks/schedule/schedule_chooser.hpp"
#include "tasks/step/control/step_controller.hpp"

namespace cvtflow::tasks {

class ScheduleRunner {
public:
    /// One candidate: that is the schedule. Several: serial first; ScheduleChooser chooses among them. Workspace and method outlive this.
    /// @throws std::invalid_argument as the catalogue's make
    ScheduleRunner(Workspace& workspace, StepMethod& method, std::vector<Schedule> candidates, const ChooserOptions& options = {},
                   engine::StampRecorder* recorder = nullptr);

    /// Runs until the controller returns stop. Allocates at the beginning, and whenever the schedule changes.
    void run(StepController& controller);
    /// Releases threads that would wait on a processor for the next run. Call it between runs.
    void release_threads() const noexcept;

    /// Builds the graphs again, with the tasks of another method.
    void take_method(StepMethod& method) noexcept;

    [[nodiscard]] const Schedule& schedule() const noexcept { return slots_[current()].schedule; }
    [[nodiscard]] const engine::TaskGraph& graph() const noexcept { return slots_[current()].graph; }
    /// Number of repartitions during the run.
    [[nodiscard]] long repartition_count() const noexcept { return repartitions_; }
    /// Number of pauses of the run.
    [[nodiscard]] long pause_count() const noexcept { return pauses_; }
    /// The schedule and the reason for it: "flow, fused, 2 segments, 2 threads (auto: 13.9 us per cycle, serial 25.2 us; 2 checks, 1
    /// change)"
    [[nodiscard]] std::string text() const;

private:
    class PausingController;
    struct Slot {
        Schedule schedule;
        std::vector<int> cuts;                         ///< borders of its segments
        std::unique_ptr<engine::Executor> executor{};  ///< made when it is first used
        engine::TaskGraph graph{};
    };

    [[nodiscard]] std::size_t current() const noexcept { return static_cast<std::size_t>(chooser_.candidate()); }
    void take_up();
    void cut_at(const std::vector<int>& cuts);
    /// Decides whether the run pauses. Called between cycles, after chooser_.window(): allocates nothing, throws nothing.
    /// @param seconds since the last call, or since the run was taken up   @param per_cycle without the first steps [s]
    [[nodiscard]] bool should_pause(double seconds, double per_cycle) noexcept;
    [[nodiscard]] bool needs_repartition() noexcept;

    Workspace& w_;
    StepMethod* method_;
    ScheduleChooser chooser_;
    std::vector<Slot> slots_;
    engine::StampRecorder* recorder_;
    std::vector<int> cuts_;  ///< room for balanced borders
    LinkCosts costs_;        ///< costs by which borders are balanced
    long repartitions_ = 0, pauses_ = 0;
};

}  // namespace cvtflow::tasks
