#pragma once
/// Effect of one step on small disturbances, measured by taking it from a state and from one next to it. Phases are held. Methods with
/// stages in single precision take the same step in double: their stability does not depend on it, and small disturbances are resolved.

#include <string_view>
#include <vector>

#include "bench/study/stability/frozen_step.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow::bench {

class TakenStep {
public:
    virtual ~TakenStep() = default;
    /// The next steps have this length. false: the method refuses or fails. h [s]
    [[nodiscard]] virtual bool prepare(double h) = 0;
    /// To what else may show that disturbances die out: another state, one step further along. false: nothing.
    [[nodiscard]] virtual bool move_on() = 0;
    /// Numbers of a disturbance: the state, then what the method remembers.
    [[nodiscard]] virtual int size() const noexcept = 0;
    /// A disturbance of the state alone: what a method remembers is not all of it linear. [size()]
    [[nodiscard]] virtual std::vector<double> mixed_start() const = 0;
    /// The step from the state plus `from`, less the step from the state, over the size of `from`. false: the method failed. from
    /// [unknowns], to [unknowns]
    [[nodiscard]] virtual bool step(const double* from, double* to) = 0;

protected:
    TakenStep() = default;
    TakenStep(const TakenStep&) = default;
    TakenStep& operator=(const TakenStep&) = default;
};

/// The simulation's own step, memory of the method included, along its way.
class RealStep final : public TakenStep {
public:
    /// @throws SimulationError as Simulation
    RealStep(const tasks::Scene& scene, std::string_view method, const tasks::FrozenStart& start);

    /// Takes two steps, so that the method has a past. h [s]
    bool prepare(double h) override;
    bool move_on() override;
    int size() const noexcept override { return static_cast<int>(scale_.size()); }
    std::vector<double> mixed_start() const override;
    bool step(const double* from, double* to) override;  ///< from [unknowns], to [unknowns]

private:
    [[nodiscard]] bool take(tasks::IntegrationState& state);

    tasks::Simulation simulation_;
    const tasks::FrozenStart start_;
    double h_ = 0.0;  ///< [s]
    tasks::IntegrationState base_, image_, moved_;
    std::vector<double> scale_;  ///< what counts as one [unknowns]
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
    bool step(const double* from, double* to) override;  ///< from [unknowns], to [unknowns]

private:
    const model::ChainLayout layout_;
    const tasks::FrozenStart start_;
    FrozenStepper stepper_;
    static constexpr int trials = 5;
    int trial_ = 0;
    double h_ = 0.0;                     ///< [s]
    std::vector<double> scale_, moved_;  ///< [unknowns]
};

}  // namespace cvtflow::bench
