#include "bench/study/spectrum.hpp"

#include "bench/method/jacobian/difference_jacobian.hpp"
#include "bench/method/linear/eigenvalues.hpp"

namespace cvtflow::bench {

using namespace tasks;

std::vector<double> jacobian(const model::Variator& variator, double t, const std::vector<double>& state,
                             const std::vector<model::Phase>& phases) {
    return bench::difference_jacobian(variator, t, state, phases);
}

std::vector<std::complex<double>> spectrum(const model::Variator& variator, double t, const std::vector<double>& state,
                                           const std::vector<model::Phase>& phases) {
    return bench::eigenvalues(jacobian(variator, t, state, phases), static_cast<int>(state.size()));
}

}  // namespace cvtflow::bench
