#pragma once
/// Ends of steps: points of a grid, and times at which an input may jump or bend.

#include "model/force/pulley.hpp"
#include "tasks/step/control/step_control.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

/// Times at which fixed and automatic steps end. Outputs are `output_interval` apart; between two of them lie one or more legs, equally
/// long, at whose ends the length of steps may change; a leg is divided into equal steps.
struct StepGrid {
    double begin = 0.0, output_interval = 0.0;  ///< [s]
    long legs_per_output = 1;
    long steps_per_leg = 1;
    double step = 0.0;        ///< [s]
    bool free = false;        ///< steps between outputs follow their error
    long leg = 0, point = 0;  ///< legs passed, and points of the present leg

    /// Steps of at most this length [s].
    void divide(double longest) noexcept;
    [[nodiscard]] double leg_length() const noexcept { return output_interval / static_cast<double>(legs_per_output); }
    /// Times of the present point and of the next one [s].
    [[nodiscard]] double here() const noexcept { return time(leg, point); }
    /// Begin of the present leg [s].
    [[nodiscard]] double leg_begin() const noexcept { return time(leg, 0); }
    [[nodiscard]] double next() const noexcept { return point + 1 < steps_per_leg ? time(leg, point + 1) : time(leg + 1, 0); }
    [[nodiscard]] bool at_output(long outputs) const noexcept { return point == 0 && leg == outputs * legs_per_output; }
    /// Steps from the present point to the output after `outputs` ones; between outputs infinite where nothing is known of their lengths.
    [[nodiscard]] double steps_to_output(long outputs) const noexcept;
    void pass() noexcept;
    /// Takes up a grid of `steps` per leg after `points` of its points.
    void continue_at(long points, long steps) noexcept {
        divide(leg_length() / static_cast<double>(steps));
        leg = points / steps_per_leg;
        point = points % steps_per_leg;
    }

private:
    [[nodiscard]] double time(long of_leg, long of_point) const noexcept;
};

/// Grid of a run; its points are the outputs where the error decides the step.
[[nodiscard]] StepGrid grid_of(const StepSettings& settings) noexcept;

/// First point after t of the tables of inputs that are in use; infinite: none. Between two points inputs are smooth in time. t [s]
[[nodiscard]] double next_input_point(const model::Parameters& parameters, const model::HeldInputs& held, double t) noexcept;

/// End of a step that begins now: the grid's next point, or a point of an input's table before it [s]. Inputs may jump at such points, and
/// their works are exact only where they are linear over a step. Reports a point that is now to the energy ledger: a fast transient may
/// follow.
[[nodiscard]] double next_step_end(Workspace& workspace, const StepGrid& grid) noexcept;

}  // namespace cvtflow::tasks
