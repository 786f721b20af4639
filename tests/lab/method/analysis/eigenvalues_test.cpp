#include "bench/method/analysis/eigenvalues.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace cvtflow::bench {
namespace {

using Complex = std::complex<double>;

/// Damped oscillators x'' = -2 ζ ω x' - ω² x as [x | v] each, chained weakly upwards: block triangular, so that their eigenvalues stay.
std::vector<double> oscillators(int count, double first, double ratio, double damping) {
    const auto n = static_cast<std::size_t>(2 * count);
    std::vector<double> matrix(n * n, 0.0);
    double frequency = first;
    for (std::size_t k = 0; k < n; k += 2, frequency *= ratio) {
        matrix[(k + 1) * n + k] = 1.0;
        matrix[k * n + k + 1] = -frequency * frequency;
        matrix[(k + 1) * n + k + 1] = -2.0 * damping * frequency;
        if (k + 2 < n) matrix[(k + 2) * n + k + 1] = 0.5 * frequency * frequency;
    }
    return matrix;
}

TEST(Eigenvalues, OfOscillatorsAreTheirFrequencies) {
    const int count = 30;
    const Eigenvalues values = eigenvalues(oscillators(count, 1e3, 1.3, 0.02), 2 * count);
    ASSERT_EQ(values.size(), 60u);
    double frequency = 1e3;
    for (int k = 0; k < count; ++k, frequency *= 1.3) {
        const Complex expected = frequency * Complex(-0.02, std::sqrt(1.0 - 0.02 * 0.02));
        double nearest = INFINITY;
        for (const Complex& value : values) nearest = std::min(nearest, std::abs(value - expected));
        EXPECT_LT(nearest, 1e-9 * frequency);
    }
}

TEST(Eigenvalues, BalancingIsExactAndMakesRowsAsLongAsColumns) {
    std::vector<double> matrix = oscillators(10, 1e5, 1.2, 0.1);
    const std::vector<double> before = matrix;
    balance(matrix, 20);
    for (std::size_t i = 0; i < 20; ++i) {
        for (std::size_t j = 0; j < 20; ++j) {
            // a_ij a_ji does not change, and powers of 2 round nothing.
            EXPECT_EQ(matrix[i * 20 + j] * matrix[j * 20 + i], before[i * 20 + j] * before[j * 20 + i]);
        }
    }
    // x and v of an oscillator: 1 and ω² become about ω each.
    EXPECT_NEAR(std::log2(std::abs(matrix[1]) / matrix[20]), 0.0, 2.0);
}

TEST(Eigenvalues, ExtremalOnesOfATriangularMatrixAreItsDiagonal) {
    const int size = 400;
    std::vector<double> matrix(static_cast<std::size_t>(size) * size, 0.0);
    for (int k = 0; k < size; ++k) {
        matrix[static_cast<std::size_t>(k) * size + k] = -std::pow(1.05, k);
        if (k > 0) matrix[static_cast<std::size_t>(k) * size + k - 1] = 0.1;
    }
    const double border = -std::pow(1.05, 349.5);
    const ExtremalEigenvalues found = extremal_eigenvalues(matrix, size, {.left_of = border, .first_dimension = 40, .progress = {}});
    ASSERT_GE(found.values.size(), 50u);
    for (int k = 0; k < 50; ++k) EXPECT_NEAR(found.values[static_cast<std::size_t>(k)].real() / -std::pow(1.05, 399 - k), 1.0, 1e-6) << k;
    EXPECT_LE(found.residual, 1e-6);
    EXPECT_LT(found.dimension, size);
}

TEST(Eigenvalues, OfASmallMatrixAreExtremalAndComplete) {
    const ExtremalEigenvalues found = extremal_eigenvalues({-2.0, 0.0, 0.0, -5.0}, 2, {.left_of = -1.0, .progress = {}});
    ASSERT_EQ(found.values.size(), 2u);
    EXPECT_NEAR(found.values[0].real(), -5.0, 1e-14);
    EXPECT_NEAR(found.values[1].real(), -2.0, 1e-14);
}

}  // namespace
}  // namespace cvtflow::bench
