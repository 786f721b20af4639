#pragma once
/// Leapfrog with friction solved for inside the step, by a diagonally implicit method on velocities alone. What is held constant over the
/// step and what is let go on within it are as in tasks/method/friction/staged/friction_leapfrog.hpp; the table of stages is another:
///
///     v_s = v + h Σ a_sj (G_j + F_j) + γ h (G_s + F(v_s))         a nonlinear solve per stage (tasks/method/friction/friction_solve.hpp)

#include <span>
#include <vector>

#include "tasks/method/friction/friction_solve.hpp"
#include "tasks/method/friction/leapfrog_frame.hpp"

namespace cvtflow::tasks {

/// A diagonally implicit method whose last stage is its result.
struct DirkTable {
    int order;
    double gamma;                              ///< [1]
    std::vector<double> times;                 ///< c [h]
    std::vector<std::vector<double>> weights;  ///< a_sj, j < s

    /// Σ b c: where a slope that is linear in time has its mean.
    [[nodiscard]] double centre() const noexcept;
    /// b.
    [[nodiscard]] double weight(int stage) const noexcept;
    /// As KickTable::extrapolation(). rise [1]
    [[nodiscard]] double extrapolation(int stage, double rise) const noexcept;
};
/// Backward Euler: order 1, what friction holds is at rest after one step.
[[nodiscard]] DirkTable backward_euler();
/// Two stages, γ = 1 - 1/√2: order 2, L-stable. (R. Alexander, SIAM J. Numer. Anal. 14, 1977)
[[nodiscard]] DirkTable sdirk2();

class ImplicitLeapfrog final : public FrictionImplicit {
public:
    /// Slots of the workspace that the method uses.
    static constexpr int state_slots = LeapfrogFrame::state_slots, slope_slots = LeapfrogFrame::slope_slots;

    ImplicitLeapfrog(Workspace& workspace, DirkTable table);

    [[nodiscard]] NextCycle begin() override;
    [[nodiscard]] NextCycle next() override;
    void restart() noexcept override { frame_.restart(); }
    void save(std::vector<double>& memory) const override;
    void load(std::span<const double> memory) override;  ///< memory [what save() wrote]

    void record(int segment) noexcept override;
    void gather(int group) noexcept override;
    void base(int group) noexcept override;
    void stage(int group) noexcept override;
    void finish(int group) noexcept override;

private:
    enum class At { evaluate, record, gather, solve, stage, finish };

    /// What a group remembers beside its contacts.
    struct Kick {
        model::LaneRows start, base, before;  ///< v; accelerations by all but friction, of this step and of the one before
        std::vector<model::LaneRows> slopes;  ///< [stage]
        model::LaneRows begun;                ///< slips where the step begins
        model::LaneRows impulses;             ///< mean force of the tips' friction along their tangents [8]
    };

    NextCycle after_solve(NextCycle cycle);
    void guess(int group, double share) noexcept;  ///< share [1]
    void predict(int group) noexcept;
    void end_stage(int group) noexcept;
    void react(int group) noexcept;

    LeapfrogFrame frame_;
    const DirkTable table_;
    std::vector<Kick> kicks_;  ///< [group]
    At at_ = At::evaluate;
    int stage_ = 0;
};

}  // namespace cvtflow::tasks
