#pragma once
/// Runs steps under a schedule that may change on the way: another of several candidates when the machine's load or the chain's phases
/// change, other borders of segments when links begin or cease to touch.

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "tasks/schedule/schedule.hpp"
#include "tasks/schedule/schedule_chooser.hpp"
#include "tasks/step/control/step_controller.hpp"

namespace cvtflow::tasks {

/// Decides whether a run pauses. Called between cycles: allocates nothing, throws nothing.
class PauseCondition {
public:
    virtual ~PauseCondition() = default;
    /// Time between two calls of should_pause() [s].
    [[nodiscard]] virtual double window() const noexcept = 0;
    /// @param seconds since the last call, or since the run was taken up   @param per_cycle without the first steps [s]
    [[nodiscard]] virtual bool should_pause(double seconds, double per_cycle) noexcept = 0;

protected:
    PauseCondition() = default;
    PauseCondition(const PauseCondition&) = default;
    PauseCondition& operator=(const PauseCondition&) = default;
};

/// Passes the step controller's decisions on. At the end of every fourth step it reads the clock, and at the end of a window it calls
/// should_pause(). To pause, it holds back the next step's first cycle and returns stop; the next Executor::run() begins with that cycle.
/// The step controller prepares that cycle in the workspace, independently of segments, so results are bitwise those of an unbroken run.
class PausingController final : public engine::Controller {
public:
    PausingController(StepController& whole, PauseCondition& condition) : whole_(whole), condition_(condition) {}

    [[nodiscard]] int next() noexcept override;
    /// Whether the step controller has returned stop: the run is complete.
    [[nodiscard]] bool over() const noexcept { return over_; }

private:
    using Clock = std::chrono::steady_clock;
    static constexpr int stride = 4;  ///< steps between readings of the clock; the first stride is not counted because threads start then

    [[nodiscard]] bool pauses() noexcept;

    StepController& whole_;
    PauseCondition& condition_;
    bool over_ = false;
    int held_ = stop;                ///< cycle kept back
    long steps_ = 0, readings_ = 0;  ///< steps seen; readings of the clock since the run was taken up
    long cycles_ = 0;                ///< since `counted_`
    Clock::time_point taken_up_ = Clock::now(), counted_ = taken_up_;
};

class ScheduleRunner final : private PauseCondition {
public:
    /// One candidate: that is the schedule. Several: serial first; ScheduleChooser chooses among them. Workspace and
    /// method outlive this.
    /// @throws std::invalid_argument as the catalogue's make
    ScheduleRunner(Workspace& workspace, StepMethod& method, std::vector<Schedule> candidates, const ChooserOptions& options = {},
                   engine::StampRecorder* recorder = nullptr);

    /// Runs until the controller returns stop. Allocates at the beginning and whenever the schedule changes, not in between.
    void run(StepController& controller);
    /// Between runs: releases threads that would wait for the next run on a processor.
    void release_threads() const noexcept;

    /// Graphs are built anew, with the tasks of another method.
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
    struct Slot {
        Schedule schedule;
        std::vector<int> cuts;                         ///< borders of its segments
        std::unique_ptr<engine::Executor> executor{};  ///< made when it is first used
        engine::TaskGraph graph{};
    };

    [[nodiscard]] std::size_t current() const noexcept { return static_cast<std::size_t>(chooser_.candidate()); }
    void take_up();
    void cut_at(const std::vector<int>& cuts);
    [[nodiscard]] double window() const noexcept override { return chooser_.window(); }
    [[nodiscard]] bool should_pause(double seconds, double per_cycle) noexcept override;  ///< seconds [s], per_cycle [s]
    [[nodiscard]] bool needs_repartition() noexcept;

    Workspace& w_;
    StepMethod* method_;
    ScheduleChooser chooser_;
    std::vector<Slot> slots_;
    engine::StampRecorder* recorder_;
    std::vector<int> cuts_;  ///< room for balanced borders
    LinkCosts costs_;        ///< by which they are balanced
    long repartitions_ = 0, pauses_ = 0;
};

}  // namespace cvtflow::tasks
