/// Inputs that a host holds in place of a scene's tables.

#include "api/simulation/simulation_impl.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "api/host/translate.hpp"
#include "engine/base/spelling.hpp"
#include "tasks/method/stability/predicted_step.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/run/step_advice.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml/units.hpp"

namespace cvtflow {
inline namespace v0 {

namespace {

/// An input: its name, its key in scenes, whose range holds for it, and what a scene must have for it.
struct InputRow {
    const char* name;
    const char* key;
    std::optional<double> model::HeldInputs::*held;
    const model::TimeTable& (*table)(const model::Parameters&);
    bool (*present)(const model::Parameters&);
    const char* needs;
};

using P = model::Parameters;
[[nodiscard]] bool always(const P&) { return true; }
[[nodiscard]] bool by_torque(const P& p) { return p.drive.mode == model::DriveMode::torque; }
[[nodiscard]] bool by_speed(const P& p) { return p.drive.mode == model::DriveMode::speed; }
[[nodiscard]] bool controlled(const P& p) { return p.control.enabled && p.control.quantity == model::ControlledQuantity::ratio; }

constexpr InputRow input_rows[] = {
    {"clamping_driving", "clamping.driving", &model::HeldInputs::driving,
     [](const P& p) -> const model::TimeTable& { return p.clamping.driving; }, always, ""},
    {"clamping_driven", "clamping.driven", &model::HeldInputs::driven,
     [](const P& p) -> const model::TimeTable& { return p.clamping.driven; }, always, ""},
    {"load_torque", "load.torque", &model::HeldInputs::load_torque, [](const P& p) -> const model::TimeTable& { return p.load.torque; },
     always, ""},
    {"drive_torque", "drive.torque", &model::HeldInputs::drive_torque, [](const P& p) -> const model::TimeTable& { return p.drive.torque; },
     by_torque, "drive.mode = \"torque\""},
    {"drive_speed", "drive.speed", &model::HeldInputs::drive_speed, [](const P& p) -> const model::TimeTable& { return p.drive.speed; },
     by_speed, "drive.mode = \"speed\""},
    {"ratio", "control.ratio", &model::HeldInputs::ratio, [](const P& p) -> const model::TimeTable& { return p.control.ratio; }, controlled,
     "control.enabled = true and control.quantity = \"ratio\""},
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

}  // namespace

InputInfo input_info(Input input) {
    return api::entered(ErrorCode::internal, [&] {
        const InputRow& row = input_row(input);
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
    const tasks::Parameter& range = *tasks::find_parameter(row.key);
    if (!(value >= range.min && value <= range.max)) {
        throw Error(ErrorCode::argument, std::string(row.key) + ": " + tasks::number_text(value) + " is outside [" +
                                             tasks::number_text(range.min) + ", " + tasks::number_text(range.max) + "] " +
                                             std::string(range.unit));
    }
    const model::PulleyModel& pulleys = simulation_.variator().pulleys();
    model::HeldInputs held = pulleys.held();
    if (input == Input::drive_speed) {  // the reference angle goes on from where it is
        held.angle = pulleys.reference_angle(simulation_.time());
        held.since = simulation_.time();
    }
    held.*row.held = value;
    hold(held);
    simulation_.inputs_changed();
}

double Simulation::Impl::input(Input input) const {
    const InputRow& row = input_row(input, data());
    const auto& held = simulation_.variator().pulleys().held().*row.held;
    return held ? *held : row.table(data().parameters).at(std::max(simulation_.time(), 0.0));
}

}  // namespace v0
}  // namespace cvtflow
