#pragma once
/// Additive Runge-Kutta with friction implicit in velocities and all else explicit:
///
///     q_i = q + h Σ aE_ij v_j        v_i = v + h Σ (aE_ij (F_j - f_j) + aI_ij f_j) + γ h f_i(v_i)        y⁺ = y + h Σ b_i F_i
///
/// F_i: the whole right-hand side at (q_i, v_i), evaluated as for any other method; f_i: accelerations of the links by friction, with
/// contacts and normal forces at q_i and at velocities predicted with the friction of the stage before. Pulleys, control and ledger are
/// explicit.
///
///     evaluate ─► [record ─► gather] ─► stage ─► record ─► gather ─► solve ─► finish ─► evaluate ─► stage ─► …

#include "tasks/method/friction/additive/additive_table.hpp"
#include "tasks/method/friction/friction_solve.hpp"

namespace cvtflow::tasks {

class AdditiveMethod final : public FrictionImplicit {
public:
    /// Slots of the workspace that the method uses: the start and the stage at hand; the controller's slope, then one of each stage.
    static constexpr int state_slots = 2;
    [[nodiscard]] static int slope_slots(const AdditiveTable& table) noexcept { return table.stages() + 1; }

    AdditiveMethod(Workspace& workspace, AdditiveTable table);

    [[nodiscard]] NextCycle begin() override;
    [[nodiscard]] NextCycle next() override;
    [[nodiscard]] std::optional<engine::PlanStep> error_row() const noexcept override;
    [[nodiscard]] int error_power() const noexcept override { return table_.embedded.empty() ? 0 : table_.order; }

    void record(int segment) noexcept override;
    void gather(int group) noexcept override;
    void base(int group) noexcept override;
    void stage(int group) noexcept override;
    void finish(int group) noexcept override;

private:
    enum class At { evaluate, record, gather, stage, solve, finish };

    /// Lanes of one group.
    struct Stages {
        model::LaneRows explicit_velocity;      ///< v_i before its own friction acts
        std::vector<model::LaneRows> friction;  ///< [stage] f_i
    };

    NextCycle evaluate(std::span<const engine::Term> states) noexcept;
    NextCycle after_evaluation();
    NextCycle after_gathering();
    NextCycle after_solve(NextCycle cycle);
    NextCycle start_stage();
    [[nodiscard]] bool predicts_from_start() const noexcept;
    [[nodiscard]] double* stage_state() noexcept { return w_.states[1]; }
    [[nodiscard]] double* slope(int stage) const noexcept { return w_.slopes[static_cast<std::size_t>(stage) + 1]; }

    const AdditiveTable table_;
    std::vector<engine::Term> weights_, error_;  ///< result and error estimate by slope slots
    std::vector<Stages> stages_;                 ///< [group]
    At at_ = At::evaluate;
    int stage_ = 0;
};

}  // namespace cvtflow::tasks
