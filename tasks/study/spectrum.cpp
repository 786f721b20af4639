#include "tasks/study/spectrum.hpp"

#include "engine/linear/eigenvalues.hpp"

namespace cvtflow::tasks {

namespace {

/// Whether an unknown is a velocity (or a first-order unknown), not a coordinate.
[[nodiscard]] bool is_velocity(const model::ChainLayout& at, int index) noexcept {
    if (index < at.pulley_begin()) return index % at.link_block() >= at.link_size();
    return index >= at.pulley_begin() + at.pulley_size;
}

}  // namespace

std::vector<double> jacobian(const model::Variator& variator, double t, const std::vector<double>& state,
                             const std::vector<model::Phase>& phases) {
    const model::ChainLayout& at = variator.layout();
    const std::size_t n = state.size();
    model::EvaluationScratch scratch(at);
    std::vector<double> moved = state;
    std::vector<double> above(n);
    std::vector<double> below(n);
    std::vector<double> matrix(n * n);
    for (std::size_t k = 0; k < n; ++k) {
        const double step = is_velocity(at, static_cast<int>(k)) ? 1e-6 : 1e-9;
        const double up = state[k] + step;
        const double down = state[k] - step;
        moved[k] = up;
        model::right_hand_side(variator, t, moved.data(), phases.data(), above.data(), scratch);
        moved[k] = down;
        model::right_hand_side(variator, t, moved.data(), phases.data(), below.data(), scratch);
        moved[k] = state[k];
        for (std::size_t row = 0; row < n; ++row) matrix[k * n + row] = (above[row] - below[row]) / (up - down);
    }
    return matrix;
}

std::vector<std::complex<double>> spectrum(const model::Variator& variator, double t, const std::vector<double>& state,
                                           const std::vector<model::Phase>& phases) {
    return engine::eigenvalues(jacobian(variator, t, state, phases), static_cast<int>(state.size()));
}

}  // namespace cvtflow::tasks
