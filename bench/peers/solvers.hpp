#pragma once
/// SUNDIALS on a Problem. No type of its own leaves this folder.

#include <string>
#include <vector>

#include "bench/peers/problem.hpp"

namespace cvtflow::bench {

struct PeerRun {
    std::string fault;  ///< empty: it came to the end
    double seconds = 0.0;
    long steps = 0, evaluations = 0, jacobians = 0;
    Trajectory trajectory;
};

struct Peer {
    std::string name, description;
    /// @param tolerance relative one; absolute ones are it times the unknowns' sizes [1]
    PeerRun (*run)(Problem& problem, double tolerance);
};

[[nodiscard]] const std::vector<Peer>& peers();
/// "6.4.1"
[[nodiscard]] std::string sundials_version();

}  // namespace cvtflow::bench
