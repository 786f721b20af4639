#pragma once
/// States of an integration. The full one between two steps: an integration that resumes from it continues bit for bit. A simulation
/// returns and accepts it (Simulation::integration_state, restore, advance); checkpoint.hpp keeps it on disk.

#include <cstddef>
#include <span>
#include <vector>

#include "engine/base/archive.hpp"
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
    model::HeldInputs held;                     ///< inputs that are held, and where couplings have taken over
    std::vector<std::byte> energy;  ///< fields of works, losses, balances and temperatures so far (write_sums); empty: not started
    std::vector<std::byte> method;  ///< fields of automatic step, error control and method between two steps; empty: not started

    bool operator==(const IntegrationState&) const = default;
    void visit(engine::Archive& archive);
    /// Reason why this state is invalid for every scene (counts, lengths, phases); nullptr if valid.
    [[nodiscard]] const char* invalid_reason() const noexcept;
};

/// Fields of the sums of a workspace: EnergyLedger, HeatBalance.
void write_sums(Workspace& workspace, std::vector<std::byte>& fields);
/// After their restart(). Empty: nothing to read. @throws engine::ArchiveError
void read_sums(Workspace& workspace, std::span<const std::byte> fields);

/// A state and the phases that hold from there on.
struct FrozenStart {
    double time = 0.0;                 ///< [s]
    std::vector<double> state;         ///< [layout.size()]
    std::vector<model::Phase> phases;  ///< [4 links]
    double balance_error_ratio = 0.0;  ///< ratio of the integration that led here; above 1 the state is wrong
};

}  // namespace cvtflow::tasks
