#include "bench/method/jacobian/difference_jacobian.hpp"

namespace cvtflow::bench {

bool is_velocity(const ChainLayout& at, int index) noexcept {
    if (index < at.pulley_begin()) return index % at.link_block() >= at.link_size();
    return index >= at.pulley_begin() + at.pulley_size;
}

std::vector<double> difference_jacobian(const Variator& variator, double t, const std::vector<double>& state,
                                        const std::vector<Phase>& phases) {
    const ChainLayout& at = variator.layout();
    const std::size_t n = state.size();
    EvaluationScratch scratch(at);
    std::vector<double> moved = state;
    std::vector<double> above(n);
    std::vector<double> below(n);
    std::vector<double> matrix(n * n);
    for (std::size_t k = 0; k < n; ++k) {
        const double step = is_velocity(at, static_cast<int>(k)) ? 1e-6 : 1e-9;
        const double up = state[k] + step;
        const double down = state[k] - step;
        moved[k] = up;
        right_hand_side(variator, t, moved.data(), phases.data(), above.data(), scratch);
        moved[k] = down;
        right_hand_side(variator, t, moved.data(), phases.data(), below.data(), scratch);
        moved[k] = state[k];
        for (std::size_t row = 0; row < n; ++row) matrix[k * n + row] = (above[row] - below[row]) / (up - down);
    }
    return matrix;
}

}  // namespace cvtflow::bench
