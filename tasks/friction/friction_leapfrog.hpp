#pragma once
/// Leapfrog with friction integrated inside the step. Elasticity limits the step (ω h < 2), friction does not:
///
///     q ← q + h/2 v
///     G, contacts: everything but friction's velocities, at q and at velocities extrapolated over the half step
///     v ← friction and G(t) over h, by a table of stages;  G(t) = G + (t/h - 1/2) ΔG, ΔG its change since the step before
///     q ← q + h/2 v
///
/// ΔG does not change the impulse of G over the step, so it leaves the leapfrog of elastic modes alone; but velocities that friction holds in
/// balance with G end in balance with the forces of the step's end instead of its middle. Without it they lag, and the order falls to one.

#include <memory>
#include <vector>

#include "tasks/friction/friction_system.hpp"
#include "tasks/step_method.hpp"

namespace cvtflow::tasks {

class FrictionLeapfrog final : public StepMethod {
public:
    /// Slots of the workspace that the method uses.
    static constexpr int state_slots = 2, slope_slots = 3;

    explicit FrictionLeapfrog(Workspace& workspace);

    [[nodiscard]] int begin() override;
    [[nodiscard]] int next() override;
    void add_tasks(engine::TaskGraph& graph) const override;
    [[nodiscard]] bool retakes() const noexcept override { return true; }
    void restart() noexcept override { continues_ = false; }

    // Bodies of tasks.
    void record(int segment) noexcept;
    void subtract(int segment) noexcept;
    void stage(int segment) noexcept;
    void finish(int segment) noexcept;

private:
    enum class State { evaluating, recording, subtracting, stages, finishing };

    void extrapolate();
    void set_row(int stage);
    int start_kick();
    int end_step();
    void choose_table();

    Workspace& w_;
    FrictionSystem system_;
    std::vector<engine::CompiledPlan> tables_;         ///< RKC of 2, 3 … stages
    std::vector<std::vector<double>> weights_;         ///< of their stages in the result
    State state_ = State::evaluating;
    bool continues_ = false;     ///< there is a step before the one at hand
    double begun_ = -1e300;      ///< where the step at hand began [s]
    double length_ = 0.0;        ///< of the last step taken
    double length_before_ = 0.0; ///< of the one before
    model::ContactDrift drift_;
    model::SheaveMotion sheaves_before_[4]{};
    double rise_ = 0.0;          ///< ΔG in units of the difference of the last two G
    std::size_t table_ = 0;
    int stage_ = 0;
    engine::PlanStep row_{};
    double weight_ = 0.0;
    double lean_ = 0.0;          ///< of G at the stage at hand, in units of the difference of the last two
    long steps_ = 0;
    double radius_ = 0.0;
};

}  // namespace cvtflow::tasks
