#pragma once
/// A method on trial: from one state over a short time, with transitions, against a tight reference. Its cost and its error.

#include <optional>
#include <string>
#include <vector>

#include "bench/method/implicit/trapezoidal.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow::bench {

/// End of a trial.
struct TrialEnd {
    tasks::Fault fault;
    tasks::Counters counters;
    double step = 0.0;                              ///< step in use [s]
    double wall = 0.0;                              ///< [s]
    std::optional<bench::NewtonStatistics> newton;  ///< statistics of trapezoidal methods
    std::string report;                             ///< summary of the method about its work
    std::vector<double> state;                      ///< [layout.size()]
    std::vector<double> axial_force, tension;       ///< axial force of every tip, tension of every link [N]
};

/// Serial run of the method `name` from `start` over `duration` with the given step.
/// step [s]
/// @throws std::invalid_argument for an unknown method
[[nodiscard]] TrialEnd try_method(const model::Parameters& parameters, const tasks::FrozenStart& start, const std::string& name,
                                  double step, double duration);

}  // namespace cvtflow::bench
