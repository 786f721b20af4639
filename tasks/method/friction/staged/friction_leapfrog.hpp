#pragma once
/// Leapfrog with friction integrated inside the step. Elasticity limits the step (ω h < 2), friction does not:
///
///     q ← q + h/2 v
///     G, contacts: everything but friction's velocities, at q and at velocities extrapolated over the half step
///     v ← friction and G over h, by a table of stages
///     q ← q + h/2 v
///
/// Friction is stiff, so velocities follow whatever it is tied to, and what is held constant over the step makes them late by half a step.
/// Two things are therefore let go on within it: the sheaves' surface under a tip turns with the tip (a tenth of the saturation speed in 1
/// µs), and G(t) = G + (t/h - 1/2) ΔG, with ΔG its change since the step before, which leaves the impulse of G and so the leapfrog alone.

#include <array>

#include "tasks/method/friction/leapfrog_frame.hpp"
#include "tasks/method/friction/staged/friction_system.hpp"
#include "tasks/method/friction/staged/kick_tables.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

/// @tparam Number in which velocities inside the step are computed: double or float
template <class Number>
class FrictionLeapfrog final : public StepMethod {
public:
    /// Slots of the workspace that the method uses.
    static constexpr int state_slots = LeapfrogFrame::state_slots, slope_slots = LeapfrogFrame::slope_slots;
    /// Factor by which the spectral radius of friction may have grown since its last estimate.
    static constexpr double margin = 1.1;  ///< [1]

    FrictionLeapfrog(Workspace& workspace, const Kick& kick);

    [[nodiscard]] NextCycle begin() override;
    [[nodiscard]] NextCycle next() override;
    void add_tasks(engine::TaskGraph& graph) override;
    void repartitioned() override { system_.repartition(w_.partition); }
    [[nodiscard]] bool retakes() const noexcept override { return true; }
    void restart() noexcept override;
    void transition() noexcept override {}  // history stays good: nothing jumps
    void save(std::vector<double>& memory) const override;
    void load(std::span<const double> memory) override;  ///< memory [what save() wrote]
    [[nodiscard]] Fault fault() const noexcept override { return fault_; }

    [[nodiscard]] std::optional<std::size_t> bytes() const noexcept override { return system_.bytes(); }

    // Bodies of tasks.
    void record(int segment) noexcept;
    void stage(int item) noexcept;  ///< item = stage of the cycle × segments + segment
    void finish(int segment) noexcept;

private:
    static constexpr int max_stages_together = 8;
    struct Stage {
        KickRow row{};
        double extrapolation = 0.0;  ///< of G, in units of the difference between the last two [1]
    };
    enum class State { evaluating, recording, stages, finishing };

    NextCycle start_kick();
    NextCycle start_stages();
    void add_kick(engine::TaskGraph& graph, int cycle, int stages);

    Workspace& w_;
    LeapfrogFrame frame_;
    FrictionSystem<Number> system_;
    const KickTables tables_;
    const KickTable* table_ = nullptr;  ///< of the step at hand
    State state_ = State::evaluating;
    int stage_ = 0;                                      ///< the first that is in no cycle yet
    std::array<Stage, max_stages_together> together_{};  ///< of the cycle at hand
    long steps_ = 0;
    double radius_ = 0.0;  ///< spectral radius of friction [1/s]
    Fault fault_;
};

}  // namespace cvtflow::tasks
