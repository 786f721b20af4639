#include "tasks/step/control/step_grid.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::tasks {

namespace {

/// A step by hand [s]. A third of 10 us is written as 3.33 us: it is that of the grid that is longer by what three digits leave out.
[[nodiscard]] double step_by_hand(const StepSettings& settings) noexcept {
    constexpr double three_digits = 1.1e-3, a_tenth_of_a_step = 0.1;
    const double steps = settings.output_interval / settings.step, whole = std::floor(steps);
    const bool is_meant = whole >= 1.0 && steps - whole <= std::min(three_digits * steps, a_tenth_of_a_step);
    return is_meant ? settings.output_interval / whole : settings.step;
}

}  // namespace

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

StepGrid grid_of(const StepSettings& settings) noexcept {
    StepGrid grid;
    grid.begin = settings.begin;
    grid.output_interval = settings.output_interval;
    const bool free = settings.control == StepControl::error;
    if (settings.automatic() && !free)
        grid.legs_per_output = static_cast<long>(std::ceil(settings.output_interval / StepChoice::ask_interval * (1.0 - 1e-12)));
    grid.divide(free ? settings.output_interval : settings.automatic() ? settings.choice->longest() : step_by_hand(settings));
    return grid;
}

}  // namespace cvtflow::tasks
