/// Inputs that a host may set between steps.

#include <algorithm>
#include <cmath>

#include "api/simulation_impl.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::api {

namespace {

using model::InputRow;

constexpr double largest_angle = 1e9;  // [rad]

static_assert(CVTFLOW_PRESSURE_DRIVEN + 1 == static_cast<int>(model::host_inputs));
static_assert(CVTFLOW_LOAD_ANGLE == static_cast<int>(model::Input::load_angle));

[[nodiscard]] const InputRow& input_row(int number) {
    if (number < 0 || number >= static_cast<int>(model::host_inputs))
        throw Error(ErrorCode::argument, "input: there is no number " + std::to_string(number));
    return model::input_table[static_cast<std::size_t>(number)];
}

[[nodiscard]] const InputRow& input_row(int input, const tasks::Scene& scene) {
    const InputRow& row = input_row(input);
    if (scene.parameters.detail.pulleys == model::PulleyDetail::absent)
        throw Error(ErrorCode::argument, std::string(row.key) + ": this scene has no pulleys");
    if (!row.acts(scene.parameters)) throw Error(ErrorCode::argument, std::string(row.key) + ": needs " + row.needs);
    return row;
}

/// @param value [unit of the input] @throws Error (argument)
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

InputText input_text(int input) {
    const InputRow& row = input_row(input);
    if (row.is_angle()) return {row.name, "rad", "Angle that the far end of the coupling has turned since t = 0."};
    const tasks::Parameter& key = *tasks::find_parameter(row.key);
    return {row.name, key.unit, key.meaning};
}

void set_input(HostSimulation& simulation, int input, double value) {
    simulation.visited([&] {
        const InputRow& row = input_row(input, simulation.scene());
        require_in_range(row, value);
        const model::PulleyModel& pulleys = simulation.simulation().workspace().variator.pulleys();
        model::HeldInputs held = pulleys.torques().held();
        const double time = simulation.simulation().time();
        if (row.turns != InputRow::none) {  // the reference turns on from where it is
            model::ReferenceAngle& reference = held.reference[static_cast<std::size_t>(row.turns)];
            if (row.is_angle() && !held.coupled)
                throw Error(ErrorCode::argument, std::string(row.name) + ": the coupling acts from t = 0 on");
            reference.angle = row.is_angle() ? reference.zero + value : pulleys.torques().reference_angle(time, row.turns);
            reference.since = time;
        }
        if (!row.is_angle()) held.values[static_cast<model::Input>(input)] = value;
        simulation.hold(held);
    });
}

double input(const HostSimulation& simulation, int input) {
    const InputRow& row = input_row(input, simulation.scene());
    const model::PulleyModel& pulleys = simulation.simulation().workspace().variator.pulleys();
    const double time = simulation.simulation().time();
    const model::HeldInputs& set = pulleys.torques().held();
    if (row.is_angle())
        return set.coupled ? pulleys.torques().reference_angle(time, row.turns) - set.reference[static_cast<std::size_t>(row.turns)].zero
                           : 0.0;
    return set.values.at(static_cast<model::Input>(input), *row.table(simulation.scene().parameters), std::max(time, 0.0));
}

}  // namespace cvtflow::api
