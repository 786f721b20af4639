#include "engine/event/interpolant.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace cvtflow::engine {
namespace {

TEST(Interpolant, ErrorIsOfFourthOrder) {
    const auto worst = [](double h) {
        const double y0 = std::exp(0.3), y1 = std::exp(0.3 + h);
        const Interpolant interpolant{&y0, &y0, &y1, &y1, h};
        double error = 0.0;
        for (double theta = 0.0; theta <= 1.0; theta += 1.0 / 64.0) {
            double y = 0.0;
            interpolant.evaluate(theta, 0, 1, &y);
            error = std::max(error, std::abs(y - std::exp(0.3 + theta * h)));
        }
        return error;
    };
    for (const double h : {0.4, 0.2, 0.1}) EXPECT_NEAR(std::log2(worst(h) / worst(0.5 * h)), 4.0, 0.15) << h;
    // Theory: max of θ²(1-θ)² h⁴ y''''/24 = h⁴ y''''/384.
    EXPECT_NEAR(worst(0.1), 1e-4 * std::exp(0.35) / 384.0, 1e-9);
}

TEST(Interpolant, IsExactForCubics) {
    const auto y = [](double t) { return ((2.0 * t - 1.0) * t + 3.0) * t - 4.0; };
    const auto slope = [](double t) { return (6.0 * t - 2.0) * t + 3.0; };
    const double y0 = y(1.0), f0 = slope(1.0), y1 = y(1.5), f1 = slope(1.5);
    for (const double theta : {0.1, 0.5, 0.9}) {
        double value = 0.0;
        Interpolant{&y0, &f0, &y1, &f1, 0.5}.evaluate(theta, 0, 1, &value);
        EXPECT_NEAR(value, y(1.0 + 0.5 * theta), 1e-14);
    }
}

/// Interpolant over 37 unknowns of no particular meaning.
class Vectors : public testing::Test {
protected:
    Vectors() {
        for (int i = 0; i < 4; ++i) {
            for (int j = 0; j < 37; ++j) data_[i].push_back(std::sin(1.0 + 7.0 * i + 3.1 * j));
        }
    }
    [[nodiscard]] Interpolant interpolant() const { return {data_[0].data(), data_[1].data(), data_[2].data(), data_[3].data(), 0.3}; }
    std::vector<double> data_[4];
};

TEST_F(Vectors, EndsAreBitwiseThoseOfTheStep) {
    std::vector<double> out(37);
    interpolant().evaluate(0.0, 0, 37, out.data());
    EXPECT_EQ(out, data_[0]);
    interpolant().evaluate(1.0, 0, 37, out.data());
    EXPECT_EQ(out, data_[2]);
}

TEST_F(Vectors, AnySplitOfTheRangeGivesTheSameBits) {
    std::vector<double> whole(37);
    interpolant().evaluate(0.37, 0, 37, whole.data());
    for (int cut = 0; cut <= 37; ++cut) {
        std::vector<double> parts(37);
        interpolant().evaluate(0.37, 0, cut, parts.data());
        interpolant().evaluate(0.37, cut, 37, parts.data() + cut);
        for (std::size_t i = 0; i < 37; ++i) ASSERT_EQ(std::bit_cast<std::uint64_t>(parts[i]), std::bit_cast<std::uint64_t>(whole[i]));
    }
}

}  // namespace
}  // namespace cvtflow::engine
