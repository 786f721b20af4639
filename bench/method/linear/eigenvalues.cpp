#include "bench/method/linear/eigenvalues.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace cvtflow::bench {

namespace {

/// Sum of the magnitudes in a row and in a column, the diagonal left out.
struct Lengths {
    double row = 0.0, column = 0.0;
};

Lengths lengths(const std::vector<double>& matrix, std::size_t size, std::size_t index) {
    Lengths sums;
    for (std::size_t other = 0; other < size; ++other) {
        if (other == index) continue;
        sums.column += std::abs(matrix[index * size + other]);
        sums.row += std::abs(matrix[other * size + index]);
    }
    return sums;
}

/// The power of 2 that makes a column as long as its row, nearly.
double balancing_factor(const Lengths& sums) {
    if (sums.row == 0.0 || sums.column == 0.0) return 1.0;
    const double factor = std::exp2(std::round(0.5 * std::log2(sums.row / sums.column)));
    return sums.column * factor + sums.row / factor < 0.95 * (sums.column + sums.row) ? factor : 1.0;
}

}  // namespace

void balance(std::vector<double>& matrix, int size) {
    const auto n = static_cast<std::size_t>(size);
    bool changed = true;
    for (int sweep = 0; sweep < 50 && changed; ++sweep) {
        changed = false;
        for (std::size_t index = 0; index < n; ++index) {
            const double factor = balancing_factor(lengths(matrix, n, index));
            if (factor == 1.0) continue;
            changed = true;
            for (std::size_t other = 0; other < n; ++other) matrix[index * n + other] *= factor;
            for (std::size_t other = 0; other < n; ++other) matrix[other * n + index] /= factor;
        }
    }
}

void sort_by_decay(Eigenvalues& values) {
    std::sort(values.begin(), values.end(),
              [](const auto& a, const auto& b) { return a.real() != b.real() ? a.real() < b.real() : a.imag() < b.imag(); });
}

Eigenvalues dense_eigenvalues(const double* matrix, int size) {
    const Eigen::EigenSolver<Eigen::MatrixXd> solver(Eigen::Map<const Eigen::MatrixXd>(matrix, size, size), false);
    if (solver.info() != Eigen::Success) return {};
    const auto& found = solver.eigenvalues();
    return {found.data(), found.data() + size};
}

Eigenvalues eigenvalues(std::vector<double> matrix, int size) {
    balance(matrix, size);
    Eigenvalues values = dense_eigenvalues(matrix.data(), size);
    if (values.empty() && size > 0) throw std::runtime_error("eigenvalues: the iteration does not converge");
    sort_by_decay(values);
    return values;
}

}  // namespace cvtflow::bench
