#include "tasks/step/control/step_grid.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::tasks {

void StepGrid::divide(double longest) noexcept {
    steps_per_leg = std::max(1L, static_cast<long>(std::ceil(leg_length() / longest * (1.0 - 1e-12))));
    step = leg_length() / static_cast<double>(steps_per_leg);
}

double StepGrid::time(long of_leg, long of_point) const noexcept {
    const long interval = of_leg / legs_per_output;
    const double whole = begin + static_cast<double>(interval) * output_interval;
    return whole + (static_cast<double>(of_leg % legs_per_output) * leg_length() + static_cast<double>(of_point) * step);
}

void StepGrid::pass() noexcept {
    if (++point < steps_per_leg) return;
    point = 0;
    ++leg;
}

}  // namespace cvtflow::tasks
