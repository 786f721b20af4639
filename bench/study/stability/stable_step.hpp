#pragma once
/// Largest stable step: for a method and a spectrum; by steps of a table about a held state, which confirms the spectrum without it; and
/// by the step that the simulation takes, of any method, with its effect on small disturbances of a state.

#include <complex>
#include <span>
#include <string_view>
#include <vector>

#include "bench/study/stability/frozen_step.hpp"
#include "engine/method/stage_plan.hpp"
#include "model/variator/variator.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow::bench {

struct StableStep {
    double step = 0.0;                ///< largest stable step [s]; 0: no step is
    std::complex<double> limiting{};  ///< the eigenvalue that leaves the region first [1/s]
};

/// A mode may grow this much faster than by itself and still count as stable: e-fold in 10 ms, longer than simulations. Without it, weakly
/// damped slow modes would exclude every method whose region lacks the imaginary axis, however slowly they grow.
inline constexpr double growth_rate_tolerance = 100.0;  ///< [1/s]

/// The largest h such that no mode grows with any h' ≤ h: log|R(h' λ)|/h' ≤ max(Re λ, 0) + growth_rate_tolerance. Steps are tried in
/// ratios of 1.01 from 0.1/max|λ| on, then bisected to 1e-6. The conjugate of a pair is skipped.
/// @param eigenvalues [1/s], not all zero; those at the edge of the spectrum suffice
/// @throws std::invalid_argument if all eigenvalues are zero
[[nodiscard]] StableStep largest_stable_step(const engine::StagePlan& plan, std::span<const std::complex<double>> eigenvalues);

/// The largest stable step, found by taking steps.
struct MeasuredStep {
    double stable = 0.0;    ///< longest step tried with which a small disturbance died out [s]
    double unstable = 0.0;  ///< shortest step tried with which it grew [s]; 0: none did, the limit is beyond
    long evaluations = 0;   ///< evaluations of the right-hand side
    [[nodiscard]] double limit() const noexcept { return unstable > 0.0 ? 0.5 * (stable + unstable) : stable; }
};

/// Whether a disturbance of all velocities by ± 1e-9 m/s (so little that hardly a contact comes to the kink of its law) grows in `steps`
/// steps about the held state: twofold in their second half, or a thousandfold in all, beyond natural growth.
/// @param natural_growth largest positive real part in the spectrum, or 0 [1/s]
[[nodiscard]] bool disturbance_grows(const model::Variator& variator, const engine::StagePlan& plan, const tasks::FrozenStart& start,
                                     double h, int steps, double natural_growth = 0.0);

/// Brackets the limit to 0.5 % between 0.6 and 1.6 times `expected`, with up to 2000 steps per trial, fewer for methods of many stages.
/// @param expected > 0 [s]
[[nodiscard]] MeasuredStep measured_stable_step(const model::Variator& variator, const engine::StagePlan& plan,
                                                const tasks::FrozenStart& start, double expected, double natural_growth = 0.0);

/// Effect of one step on small disturbances, measured by taking it from a state and from one next to it. Phases are held.
class TakenStep {
public:
    virtual ~TakenStep() = default;
    /// The next steps have this length. false: the method refuses or fails. h [s]
    [[nodiscard]] virtual bool prepare(double h) = 0;
    /// Moves to another size of disturbances, or to another state, one step further along, which may show that they die out. false: there
    /// is none.
    [[nodiscard]] virtual bool move_on() = 0;
    /// Numbers of a disturbance: the state, then the memory of the method.
    [[nodiscard]] virtual int size() const noexcept = 0;
    /// A disturbance of the state alone: the memory of a method is not all linear. [size()]
    [[nodiscard]] virtual std::vector<double> mixed_start() const = 0;
    /// The step from the state plus `from`, less the step from the state, over the size of `from`. false: the method failed. from
    /// [unknowns], to [unknowns]
    [[nodiscard]] virtual bool step(const double* from, double* to) = 0;

protected:
    TakenStep() = default;
    TakenStep(const TakenStep&) = default;
    TakenStep& operator=(const TakenStep&) = default;
};

/// The simulation's step, memory of the method included, along its way.
class RealStep final : public TakenStep {
public:
    /// @throws SimulationError as Simulation
    RealStep(const tasks::Scene& scene, std::string_view method, const tasks::FrozenStart& start);

    /// Takes two steps, so that the method has a past. h [s]
    bool prepare(double h) override;
    bool move_on() override;
    int size() const noexcept override { return static_cast<int>(scale_.size()); }
    std::vector<double> mixed_start() const override;
    bool step(const double* from, double* to) override;

private:
    [[nodiscard]] bool take(tasks::IntegrationState& state);

    tasks::Simulation simulation_;
    const tasks::FrozenStart start_;
    double h_ = 0.0;  ///< [s]
    tasks::IntegrationState base_, image_, moved_;
    std::size_t trial_ = 0;      ///< times moved on
    std::vector<double> scale_;  ///< size of a disturbance that counts as one [unknowns]
};

/// The step of a table with the state's drift subtracted: stages that grow a great deal would carry the drift over the kinks of friction.
class HeldStep final : public TakenStep {
public:
    HeldStep(const model::Variator& variator, const engine::StagePlan& plan, const tasks::FrozenStart& start);

    bool prepare(double h) override;  ///< h [s]
    /// The present state with another size of disturbances: small enough for the kinks, large enough for rounding.
    bool move_on() override { return ++trial_ < trials; }
    int size() const noexcept override { return static_cast<int>(scale_.size()); }
    std::vector<double> mixed_start() const override;
    bool step(const double* from, double* to) override;

private:
    const model::ChainLayout layout_;
    const tasks::FrozenStart start_;
    FrozenStepper stepper_;
    static constexpr int trials = 5;
    int trial_ = 0;
    double h_ = 0.0;                     ///< [s]
    std::vector<double> scale_, moved_;  ///< [unknowns]
};

/// The longest step with which small disturbances of a state die out, measured on the step that the simulation takes.
struct MeasuredLimit {
    double step = 0.0;     ///< longest stable one; infinite if longest_tried is [s]
    bool refused = false;  ///< longer ones are not unstable: the method does not take them
};
/// A step is unstable if disturbances of three states in a row grow: at a single state a contact may reach its kink within the step, which
/// linear stability does not cover.
/// @param expected where the search begins [s]; infinite: at lengths up to longest_tried
[[nodiscard]] MeasuredLimit measured_step_limit(const tasks::Scene& scene, std::string_view method, const tasks::FrozenStart& start,
                                                double expected);

}  // namespace cvtflow::bench
