#include "tasks/step/control/step_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cvtflow::tasks {

namespace {

/// The given step [s], or the exact divisor of the output interval that it equals to three digits: 3.33 us becomes 10 us/3.
[[nodiscard]] double fixed_step(const StepSettings& settings) noexcept {
    constexpr double three_digits = 1.1e-3, tenth_of_a_step = 0.1;
    const double steps = settings.output_interval / settings.step, whole = std::floor(steps);
    const bool divides_interval = whole >= 1.0 && steps - whole <= std::min(three_digits * steps, tenth_of_a_step);
    return divides_interval ? settings.output_interval / whole : settings.step;
}

/// A point of an input's table that is closer than this fraction of a step is where the step begins or ends.
constexpr double input_point_tolerance = 1e-6;

[[nodiscard]] double next_point(const model::TimeTable& table, double t) noexcept {
    if (table.time.size() == 1 || t >= table.time.back()) return std::numeric_limits<double>::infinity();
    return *std::upper_bound(table.time.begin(), table.time.end(), t);
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

double StepGrid::steps_to_output(long outputs) const noexcept {
    const long steps = (outputs * legs_per_output - leg) * steps_per_leg - point;
    return free && steps > 0 ? std::numeric_limits<double>::infinity() : static_cast<double>(steps);
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
    grid.free = settings.control == StepControl::error;
    if (settings.automatic() && !grid.free)
        grid.legs_per_output = static_cast<long>(std::ceil(settings.output_interval / StepChoice::ask_interval * (1.0 - 1e-12)));
    grid.divide(grid.free ? settings.output_interval : settings.automatic() ? settings.choice->longest() : fixed_step(settings));
    return grid;
}

double next_input_point(const model::Parameters& p, const model::HeldInputs& held, double t) noexcept {
    const double now = std::max(t, 0.0);  // while a start settles, inputs are those of t = 0
    double next = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < model::input_count; ++k) {
        const model::InputRow& row = model::input_table[k];
        if (!row.is_angle() && row.acts(p) && !held.values.value[k]) next = std::min(next, next_point(*row.table(p), now));
    }
    return next;
}

double next_step_end(Workspace& w, const StepGrid& grid) noexcept {
    if (w.layout().pulley_size == 0) return grid.next();
    const double now = w.step.time, tolerance = input_point_tolerance * grid.step;
    const auto after = [&](double t) { return next_input_point(w.parameters, w.variator.pulleys().torques().held(), t); };
    if (after(now - tolerance) <= now + tolerance) w.energy.inputs_changed(now, true);
    const double point = after(now + tolerance);
    return point < grid.next() - tolerance ? point : grid.next();
}

}  // namespace cvtflow::tasks
