#include "bench/study/spectrum.hpp"

#include "engine/linear/eigenvalues.hpp"
#include "model/jacobian/difference_jacobian.hpp"

namespace cvtflow::bench {

using namespace tasks;

std::vector<double> jacobian(const model::Variator& variator, double t, const std::vector<double>& state,
                             const std::vector<model::Phase>& phases) {
    return model::difference_jacobian(variator, t, state, phases);
}

std::vector<std::complex<double>> spectrum(const model::Variator& variator, double t, const std::vector<double>& state,
                                           const std::vector<model::Phase>& phases) {
    return engine::eigenvalues(jacobian(variator, t, state, phases), static_cast<int>(state.size()));
}

}  // namespace cvtflow::bench
