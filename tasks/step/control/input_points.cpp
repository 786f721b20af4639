#include "tasks/step/control/input_points.hpp"

#include <algorithm>
#include <limits>

namespace cvtflow::tasks {

namespace {

/// A point of an input's table that is closer than this fraction of a step is where the step begins or ends.
constexpr double input_point_tolerance = 1e-6;

[[nodiscard]] double next_point(const model::TimeTable& table, double t) noexcept {
    if (table.time.size() == 1 || t >= table.time.back()) return std::numeric_limits<double>::infinity();
    return *std::upper_bound(table.time.begin(), table.time.end(), t);
}

}  // namespace

double next_input_point(const model::Parameters& p, const model::HeldInputs& held, double t) noexcept {
    const double now = std::max(t, 0.0);  // while a start settles, inputs are those of t = 0
    double next = std::numeric_limits<double>::infinity();
    const auto look = [&](const model::TimeTable& table, bool in_use) {
        if (in_use) next = std::min(next, next_point(table, now));
    };
    const bool by_torque = p.drive.mode == model::DriveMode::torque, loaded = p.load.mode == model::LoadMode::torque;
    const bool controlled = p.control.enabled;
    look(p.drive.speed, !by_torque && !held.drive_speed);
    look(p.drive.torque, by_torque && !held.drive_torque);
    look(p.load.torque, loaded && !held.load_torque);
    look(p.load.speed, !loaded && !held.load_speed);
    const bool by_pressure = p.hydraulics.mode == model::HydraulicMode::pressure;
    look(p.clamping.driving, !held.driving && !by_pressure);
    look(p.clamping.driven, !held.driven && !by_pressure);
    look(p.hydraulics.driving.pressure, by_pressure && !held.driving_pressure);
    look(p.hydraulics.driven.pressure, by_pressure && !held.driven_pressure);
    look(p.hydraulics.pump_speed, p.hydraulics.mode != model::HydraulicMode::none);
    look(p.control.ratio, controlled && !held.ratio);
    look(p.control.slip, controlled);
    look(p.control.safety, controlled);
    return next;
}

double next_step_end(Workspace& w, const StepGrid& grid) noexcept {
    if (w.layout().pulley_size == 0) return grid.next();
    const double now = w.step.time, tolerance = input_point_tolerance * grid.step;
    const auto after = [&](double t) { return next_input_point(w.parameters, w.variator.pulleys().held(), t); };
    if (after(now - tolerance) <= now + tolerance) w.energy.inputs_changed(now);
    const double point = after(now + tolerance);
    return point < grid.next() - tolerance ? point : grid.next();
}

}  // namespace cvtflow::tasks
