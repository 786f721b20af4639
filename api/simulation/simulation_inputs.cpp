/// Inputs that a host holds in place of a scene's tables.

#include "api/simulation/simulation_impl.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "api/host/translate.hpp"
#include "engine/base/text.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow {
inline namespace v0 {

namespace {

/// An input: its name, its key in scenes, whose range holds for it, and what a scene must have for it. Angles of far ends have no key.
struct InputRow {
    const char* name;
    const char* key;
    std::optional<double> model::HeldInputs::*held;
    const model::TimeTable& (*table)(const model::Parameters&);
    bool (*present)(const model::Parameters&);
    const char* needs;
    int turns = none;  ///< shaft whose reference it turns, by a speed, or by an angle where `held` is nullptr

    static constexpr int none = -1;
    [[nodiscard]] bool is_angle() const noexcept { return held == nullptr; }
};
constexpr double largest_angle = 1e9;  // [rad]

using P = model::Parameters;
[[nodiscard]] bool by_pressure(const P& p) { return p.hydraulics.mode == model::HydraulicMode::pressure; }
[[nodiscard]] bool by_force(const P& p) { return !by_pressure(p); }
[[nodiscard]] bool by_torque(const P& p) { return p.drive.mode == model::DriveMode::torque; }
[[nodiscard]] bool by_speed(const P& p) { return p.drive.mode != model::DriveMode::torque; }
[[nodiscard]] bool by_coupling(const P& p) { return p.drive.mode == model::DriveMode::coupling; }
[[nodiscard]] bool loaded_by_torque(const P& p) { return p.load.mode == model::LoadMode::torque; }
[[nodiscard]] bool loaded_by_speed(const P& p) { return p.load.mode != model::LoadMode::torque; }
[[nodiscard]] bool loaded_by_coupling(const P& p) { return p.load.mode == model::LoadMode::coupling; }
[[nodiscard]] bool controlled(const P& p) { return p.control.enabled && p.control.quantity == model::ControlledQuantity::ratio; }

constexpr const char* not_by_pressure = "clamping forces, not hydraulics.mode = \"pressure\"";

constexpr InputRow input_rows[] = {
    {"clamping_driving", "clamping.driving", &model::HeldInputs::driving,
     [](const P& p) -> const model::TimeTable& { return p.clamping.driving; }, by_force, not_by_pressure},
    {"clamping_driven", "clamping.driven", &model::HeldInputs::driven,
     [](const P& p) -> const model::TimeTable& { return p.clamping.driven; }, by_force, not_by_pressure},
    {"load_torque", "load.torque", &model::HeldInputs::load_torque, [](const P& p) -> const model::TimeTable& { return p.load.torque; },
     loaded_by_torque, "load.mode = \"torque\""},
    {"drive_torque", "drive.torque", &model::HeldInputs::drive_torque, [](const P& p) -> const model::TimeTable& { return p.drive.torque; },
     by_torque, "drive.mode = \"torque\""},
    {"drive_speed", "drive.speed", &model::HeldInputs::drive_speed, [](const P& p) -> const model::TimeTable& { return p.drive.speed; },
     by_speed, "drive.mode = \"speed\" or \"coupling\"", 0},
    {"ratio", "control.ratio", &model::HeldInputs::ratio, [](const P& p) -> const model::TimeTable& { return p.control.ratio; }, controlled,
     "control.enabled = true and control.quantity = \"ratio\""},
    {"load_speed", "load.speed", &model::HeldInputs::load_speed, [](const P& p) -> const model::TimeTable& { return p.load.speed; },
     loaded_by_speed, "load.mode = \"speed\" or \"coupling\"", 1},
    {"load_angle", "load_angle", nullptr, nullptr, loaded_by_coupling, "load.mode = \"coupling\"", 1},
    {"drive_angle", "drive_angle", nullptr, nullptr, by_coupling, "drive.mode = \"coupling\"", 0},
    {"pressure_driving", "hydraulics.driving_pressure", &model::HeldInputs::driving_pressure,
     [](const P& p) -> const model::TimeTable& { return p.hydraulics.driving.pressure; }, by_pressure, "hydraulics.mode = \"pressure\""},
    {"pressure_driven", "hydraulics.driven_pressure", &model::HeldInputs::driven_pressure,
     [](const P& p) -> const model::TimeTable& { return p.hydraulics.driven.pressure; }, by_pressure, "hydraulics.mode = \"pressure\""},
};

[[nodiscard]] const InputRow& input_row(Input input) {
    const auto number = static_cast<int>(input);
    if (number < 0 || number >= static_cast<int>(std::size(input_rows)))
        throw Error(ErrorCode::argument, "input: there is no number " + std::to_string(number));
    return input_rows[number];
}

[[nodiscard]] const InputRow& input_row(Input input, const tasks::Scene& scene) {
    const InputRow& row = input_row(input);
    if (scene.parameters.detail.pulleys == model::PulleyDetail::absent)
        throw Error(ErrorCode::argument, std::string(row.key) + ": this scene has no pulleys");
    if (!row.present(scene.parameters)) throw Error(ErrorCode::argument, std::string(row.key) + ": needs " + row.needs);
    return row;
}

/// @throws Error (argument); value [unit of the input]
void require_in_range(const InputRow& row, double value) {
    if (row.is_angle()) {
        if (!(std::abs(value) <= largest_angle)) throw Error(ErrorCode::argument, std::string(row.name) + ": beyond 1e9 rad");
        return;
    }
    const tasks::Parameter& range = *tasks::find_parameter(row.key);
    if (value >= range.min && value <= range.max) return;
    throw Error(ErrorCode::argument, std::string(row.key) + ": " + tasks::number_text(value) + " is outside [" +
                                         tasks::number_text(range.min) + ", " + tasks::number_text(range.max) + "] " +
                                         std::string(range.unit));
}

}  // namespace

InputInfo input_info(Input input) {
    return api::entered(ErrorCode::internal, [&] {
        const InputRow& row = input_row(input);
        if (row.is_angle()) return InputInfo{row.name, "rad", "Angle that the far end of the coupling has turned since t = 0."};
        const tasks::Parameter& key = *tasks::find_parameter(row.key);
        return InputInfo{row.name, key.unit, key.meaning};
    });
}

void Simulation::Impl::hold(const model::HeldInputs& held) {
    simulation_.hold(held);
    observation_ = nullptr;
}

void Simulation::Impl::set_input(Input input, double value) {
    const Scope scope(*this, Scope::As::visitor);
    const InputRow& row = input_row(input, data());
    require_in_range(row, value);
    const model::PulleyModel& pulleys = simulation_.variator().pulleys();
    model::HeldInputs held = pulleys.held();
    if (row.turns != InputRow::none) {  // the reference turns on from where it is
        const double now = simulation_.time();
        model::ReferenceAngle& reference = held.reference[static_cast<std::size_t>(row.turns)];
        if (row.is_angle() && !held.coupled) throw Error(ErrorCode::argument, std::string(row.name) + ": the coupling acts from t = 0 on");
        reference.angle = row.is_angle() ? reference.zero + value : pulleys.reference_angle(now, row.turns);
        reference.since = now;
    }
    if (!row.is_angle()) held.*row.held = value;
    hold(held);
    simulation_.inputs_changed();
}

double Simulation::Impl::input(Input input) const {
    const InputRow& row = input_row(input, data());
    const model::PulleyModel& pulleys = simulation_.variator().pulleys();
    if (row.is_angle()) {
        const bool acts = pulleys.held().coupled;
        return acts ? pulleys.reference_angle(simulation_.time(), row.turns) -
                          pulleys.held().reference[static_cast<std::size_t>(row.turns)].zero
                    : 0.0;
    }
    const auto& held = pulleys.held().*row.held;
    return held ? *held : row.table(data().parameters).at(std::max(simulation_.time(), 0.0));
}

}  // namespace v0
}  // namespace cvtflow
