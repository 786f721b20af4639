#include "bench/method/implicit/newton.hpp"

#include <fmt/format.h>

namespace cvtflow::bench {

std::string text(const NewtonStatistics& s) {
    const double steps = s.steps > 0 ? static_cast<double>(s.steps) : 1.0;
    std::string line = fmt::format("{:.2f} iterations per step (max {}), {} Jacobians, {} factorisations, {} halvings",
                                   static_cast<double>(s.iterations) / steps, s.most, s.jacobians, s.factorisations, s.backtracks);
    if (s.refreshed > 0) line += fmt::format("; {} of {} steps required a new Jacobian", s.refreshed, s.steps);
    if (s.unconverged > 0)
        line += fmt::format("; {} of {} steps did not converge and used the best iterate (residual up to {:.2g} m/s)", s.unconverged,
                            s.steps, s.worst);
    return line;
}

}  // namespace cvtflow::bench
