#pragma once
/// One schedule at work on its own copy of a scene's start.

#include <cstdint>

#include "tasks/run/simulation.hpp"

namespace cvtflow::bench {

/// Time of a number of steps.
struct TrialSample {
    double wall = 0.0;  ///< [s]
    double cpu = 0.0;   ///< processor time of the whole process, all threads [s]
    long steps = 0;
    long evaluations = 0;

    [[nodiscard]] double per_step() const noexcept { return wall / static_cast<double>(steps); }
};

class Trial {
public:
    /// @throws as Simulation
    Trial(const tasks::Scene& scene, const tasks::Schedule& schedule, engine::StampRecorder* recorder = nullptr);

    /// Takes `steps` further steps, or fewer if they take longer than `timeout` [s], which is checked once per output interval. The search
    /// for the automatic step, which a run does once, is in the first call only (before a start has settled: in every call).
    /// @throws SimulationError if the simulation ends by itself: there is nothing to measure then
    TrialSample run(long steps, double timeout = 3600.0);

    [[nodiscard]] const tasks::Simulation& simulation() const noexcept { return simulation_; }

private:
    tasks::Simulation simulation_;
    bool begun_ = false;
};

/// Steps that fit into `seconds` at `per_step`; 1 to 100 000. seconds [s], per_step [s]
[[nodiscard]] long steps_within(double seconds, double per_step) noexcept;

}  // namespace cvtflow::bench
