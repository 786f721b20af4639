#pragma once
/// The full state of an integration at rest between two steps: whoever has it goes on bit for bit as if it had never stopped.
///
/// A simulation hands it out and takes it (Simulation::integration_state, restore, advance); checkpoint_file.hpp keeps it on disk.

#include <cstdint>
#include <vector>

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
    double step = 0.0;             ///< longest step asked for [s]
    double next_step = 0.0;        ///< step that a step control would try next; 0: steps of the grid [s]
    long grid_number = 0;          ///< grid points passed, of a grid of `grid_steps`
    long grid_steps = 0;           ///< steps between two points at which the length of steps may change
    long outputs = 0;              ///< outputs delivered
    Counters counters;
    std::vector<double> state;                ///< [layout.size()]
    std::vector<model::Phase> phases;         ///< [4 links]
    std::vector<double> changed;              ///< [4 links] time of the last change of phase [s]
    std::vector<model::TipIndicator> before;  ///< [4 links] depth and slip of the tips now
    double settling_suspicion = 0.0;          ///< EnergyLedger::suspicion() at the end of settling [1]
    double settling_residual = 0.0;           ///< relative residual of the energy balance then
    std::vector<double> energy;               ///< works, losses and balance so far (EnergyLedger) [what EnergyLedger::save() wrote]
    std::vector<double> step_choice;          ///< what the choice of the step remembers; empty for steps given by hand [what save() wrote]
    std::vector<double> method;  ///< what else a method remembers from step to step; empty for one-step methods [what save() wrote]

    bool operator==(const IntegrationState&) const = default;
    /// Why no integration can stand here, whatever the scene: counts and lengths that are none, unknown phases. nullptr if one may.
    [[nodiscard]] const char* unsound() const noexcept;
    /// Of every field, bit by bit.
    [[nodiscard]] std::uint64_t hash() const noexcept;
};

}  // namespace cvtflow::tasks
