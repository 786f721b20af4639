#pragma once
/// What one step makes of small disturbances, found by taking it: the step of the simulation itself, from a state and from one next to it,
/// memory of the method included. Phases are held.

#include <string_view>
#include <vector>

#include "tasks/checkpoint/integration_state.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/simulation.hpp"

namespace cvtflow::tasks {

class RealStep {
public:
    /// @throws SimulationError as Simulation
    RealStep(const Scene& scene, std::string_view method, const FrozenStart& start);

    /// The next steps have this length: takes two of them, so that the method has a past. false: the method refuses or fails.
    [[nodiscard]] bool prepare(double h);
    /// From here on, so many steps count as one.
    [[nodiscard]] bool combine(int steps);
    /// Numbers of a disturbance: the state, then what the method remembers.
    [[nodiscard]] int size() const noexcept { return static_cast<int>(scale_.size()); }
    /// A disturbance of the state alone: what a method remembers is not all of it linear. [size()]
    [[nodiscard]] std::vector<double> mixed_start() const;
    /// The step from the base plus `from`, less the step from the base, over the size of `from`. false: the method failed.
    [[nodiscard]] bool step(const double* from, double* to);

private:
    [[nodiscard]] bool take(const IntegrationState& from, IntegrationState& to);
    [[nodiscard]] bool take_one(IntegrationState& state);

    Simulation simulation_;
    const FrozenStart start_;
    double h_ = 0.0;
    int steps_ = 1;
    IntegrationState base_, image_, moved_;
    std::vector<double> scale_;   ///< what counts as one
};

}  // namespace cvtflow::tasks
