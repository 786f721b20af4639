#pragma once
/// States of an integration. The full one between two steps: an integration that resumes from it continues bit for bit. A simulation
/// returns and accepts it (Simulation::integration_state, restore, advance); checkpoint.hpp keeps it on disk.

#include <cstdint>
#include <vector>

#include "model/chain/chain_model.hpp"
#include "model/law/phase_rule.hpp"
#include "model/parameters/chain_layout.hpp"
#include "tasks/step/control/step_controller.hpp"

namespace cvtflow::tasks {

struct IntegrationState {
    bool started = false;          ///< false: nothing of this part has run yet; the fields of the grid are unset
    bool settling = false;         ///< this is the part of a run that settles a geometric start
    double time = 0.0;             ///< [s]
    double begin = 0.0;            ///< outputs are due at begin + k output_interval [s]
    double output_interval = 0.0;  ///< [s]
    double step = 0.0;             ///< longest step, as the scene gives it [s]
    long grid_number = 0;          ///< grid points passed, of a grid of `grid_steps`
    long grid_steps = 0;           ///< steps between two points at which the length of steps may change
    long outputs = 0;              ///< outputs delivered
    Counters counters;
    std::vector<double> state;                  ///< [layout.size()]
    std::vector<model::Phase> phases;           ///< [4 links]
    std::vector<double> changed;                ///< [4 links] time of the last change of phase [s]
    std::vector<model::TipIndicator> before;    ///< [4 links] depth and slip of the tips now
    double settling_balance_error_ratio = 0.0;  ///< EnergyLedger::balance_error_ratio() at the end of settling [1]
    double settling_residual = 0.0;             ///< relative residual of the energy balance then
    std::vector<double> energy;                 ///< works, losses and balance so far, from EnergyLedger::save()
    std::vector<double> step_choice;            ///< memory of the automatic step, from save(); empty for given steps
    std::vector<double> heat;                   ///< temperatures and what they balance, from HeatBalance::save(); empty without
    std::vector<double> couplings;  ///< [6 or 10] angles of both shafts since couplings took over: since, angle, zero; empty: not yet;
                                    ///< numbers of a sheave that is held
    std::vector<double> method;     ///< memory of a method, from StepMethod::save(); empty for one-step methods

    bool operator==(const IntegrationState&) const = default;
    /// Reason why this state is invalid for every scene (counts, lengths, phases); nullptr if valid.
    [[nodiscard]] const char* invalid_reason() const noexcept;
    /// Hash of all fields, bit by bit.
    [[nodiscard]] std::uint64_t hash() const noexcept;
};

/// The only list of the fields: calls visitor(name, field) for each. `state` is an IntegrationState or a const one.
template <class State, class Visitor>
void visit_fields(State& state, Visitor& visitor) {
    visitor("started", state.started);
    visitor("settling", state.settling);
    visitor("time", state.time);
    visitor("begin", state.begin);
    visitor("output_interval", state.output_interval);
    visitor("step", state.step);
    visitor("settling_error_ratio", state.settling_balance_error_ratio);
    visitor("settling_residual", state.settling_residual);
    visitor("grid_number", state.grid_number);
    visitor("grid_steps", state.grid_steps);
    visitor("outputs", state.outputs);
    visit_counters(state.counters, visitor);
    visitor("state", state.state);
    visitor("phases", state.phases);
    visitor("changed", state.changed);
    visitor("before", state.before);
    visitor("method", state.method);
    visitor("energy", state.energy);
    visitor("step_choice", state.step_choice);
    visitor("couplings", state.couplings);
    visitor("heat", state.heat);
}

/// A state and the phases that hold from there on.
struct FrozenStart {
    double time = 0.0;                 ///< [s]
    std::vector<double> state;         ///< [layout.size()]
    std::vector<model::Phase> phases;  ///< [4 links]
    double balance_error_ratio = 0.0;  ///< ratio of the integration that led here; above 1 the state is wrong
};

}  // namespace cvtflow::tasks
