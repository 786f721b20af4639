/// The fastest eigenvalues of the variator's Jacobian, found without all the others.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bench/method/analysis/eigenvalues.hpp"
#include "bench/study/spectrum.hpp"
#include "tasks/scene/scene.hpp"
#include "tests/lab/study/brief_fixture.hpp"

namespace cvtflow::bench {

using namespace tasks;
namespace {

using Complex = std::complex<double>;

/// The Jacobian of the smallest scene after a millisecond of settling.
std::vector<double> jacobian_of_tiny() {
    const FrozenStart& start = brief_start();
    return jacobian(model::Variator(brief_scene().parameters), start.time, start.state, start.phases);
}

TEST(SpectrumEdge, OfTheVariatorIsThoseOfTheDenseMethod) {
    const std::vector<double> matrix = jacobian_of_tiny();
    const int size = static_cast<int>(brief_start().state.size());
    const bench::Eigenvalues all = bench::eigenvalues(matrix, size);
    const double border = -3e5;
    const bench::ExtremalEigenvalues edge = bench::extremal_eigenvalues(matrix, size, {.left_of = border, .progress = {}});
    const auto left = std::count_if(all.begin(), all.end(), [&](const Complex& value) { return value.real() < border; });
    const auto found = std::count_if(edge.values.begin(), edge.values.end(), [&](const Complex& value) { return value.real() < border; });
    EXPECT_GT(left, 20);
    EXPECT_EQ(found, left);
    for (int k = 0; k < left; ++k)
        EXPECT_LT(std::abs(edge.values[static_cast<std::size_t>(k)] - all[static_cast<std::size_t>(k)]),
                  1e-5 * std::abs(all[static_cast<std::size_t>(k)]))
            << k;
    const auto fastest = [](const bench::Eigenvalues& values) {
        double frequency = 0.0;
        for (const Complex& value : values) frequency = std::max(frequency, std::abs(value.imag()));
        return frequency;
    };
    EXPECT_NEAR(fastest(edge.values) / fastest(all), 1.0, 1e-5);
}

}  // namespace
}  // namespace cvtflow::bench
