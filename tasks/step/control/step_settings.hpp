#pragma once
/// What decides the length of steps and the end of a run.

#include "tasks/step/control/step_choice.hpp"
#include "tasks/step/control/step_control.hpp"

namespace cvtflow::tasks {

struct StepSettings {
    double begin = 0.0;  ///< [s]
    double until = 0.0;  ///< [s]
    double step = 5e-8;  ///< longest step [s]; a fixed step divides the output interval. 0: automatic, and `choice` must be there
    double output_interval = 1e-5;  ///< [s]
    long max_steps = 0;             ///< 0: no budget
    double max_wall = 0.0;          ///< [s], 0: no budget
    StepControl control = StepControl::fixed;
    double tolerance = 1.0;        ///< of local errors, in units of ErrorScale [1]
    StepChoice* choice = nullptr;  ///< what chooses automatic steps; outlives the controller
    const bool* pause = nullptr;   ///< if true (set by an observer), the run ends before the next step as if cancelled

    [[nodiscard]] bool automatic() const noexcept { return choice != nullptr && step == 0.0; }
};

/// Local errors of accepted steps, in units of ErrorScale; only with StepControl::report and error.
struct LocalErrorStatistics {
    long steps = 0;
    double largest = 0.0;  ///< [1]
    double sum = 0.0;      ///< [1]

    [[nodiscard]] double mean() const noexcept { return steps > 0 ? sum / static_cast<double>(steps) : 0.0; }
};

}  // namespace cvtflow::tasks
