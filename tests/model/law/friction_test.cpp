#include "model/law/friction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "bench/method/jacobian/dual_lanes.hpp"
#include "model/law/friction_laws.hpp"

namespace cvtflow::model {
namespace {

const std::vector<double> speeds{0.0, 0.01, 0.03, 0.3, 2.0}, values{0.5, 0.8, 1.0, 0.4, 0.4};

[[nodiscard]] TipLaw law_of(const SpeedProfile& profile) { return {.by_speed = profile}; }

TEST(SpeedProfile, GoesThroughItsPointsAndIsConstantOutside) {
    const SpeedProfile profile = SpeedProfile::through(speeds, values);
    for (std::size_t k = 0; k < speeds.size(); ++k) EXPECT_NEAR(profile.at(speeds[k]), values[k], 1e-15) << speeds[k];  // sums of gains
    EXPECT_EQ(profile.at(100.0), profile.at(2.0));
    EXPECT_EQ(SpeedProfile::through(std::vector{0.1}, std::vector{0.7}).at(0.0), 0.7);
}

/// Between two points no value is outside theirs, and values keep their order.
TEST(SpeedProfile, IsMonotoneBetweenPoints) {
    const SpeedProfile profile = SpeedProfile::through(speeds, values);
    for (std::size_t k = 0; k + 1 < speeds.size(); ++k) {
        const double sign = values[k + 1] >= values[k] ? 1.0 : -1.0;
        double before = profile.at(speeds[k]);
        for (int i = 1; i <= 200; ++i) {
            const double now = profile.at(speeds[k] + (speeds[k + 1] - speeds[k]) * i / 200.0);
            EXPECT_GE(sign * (now - before), -1e-15) << k << " " << i;  // an ulp of 1
            before = now;
        }
    }
}

/// One-sided differences at every point, the ends included: both tend to the same slope as the step shrinks.
TEST(SpeedProfile, HasNoCorner) {
    const SpeedProfile profile = SpeedProfile::through(speeds, values);
    for (const double at : speeds) {
        for (const double step : {1e-4, 1e-5}) {
            const double right = (profile.at(at + step) - profile.at(at)) / step;
            const double left = at == 0.0 ? 0.0 : (profile.at(at) - profile.at(at - step)) / step;
            EXPECT_NEAR(left, right, 1.2e4 * step) << at;  // curvature: 2 (6 rise/width²), 0.3 over 0.01 m/s
        }
    }
}

TEST(TipFactors, LanesGiveWhatEachGivesAloneAndNumbersWithDerivativesTheSlope) {
    const TipLaw law = law_of(SpeedProfile::through(speeds, values));
    const double four[] = {0.0, 0.017, 0.2, 7.0};
    const Lanes<4> together = speed_factor<4>(law, load<4>(four)), slopes = speed_factor_slope<4>(law, load<4>(four));
    for (std::size_t lane = 0; lane < 4; ++lane) {
        const double v = four[lane];
        EXPECT_EQ(together[lane], speed_factor<1>(law, Lanes<1>(v))[0]);
        EXPECT_EQ(together[lane], law.by_speed.at(v));
        const double step = 1e-7, difference = (law.by_speed.at(v + step) - law.by_speed.at(v - step)) / (2.0 * step);
        EXPECT_NEAR(slopes[lane], difference, 1e-3);  // curvature 1.2e4 times the step
        constexpr int one = directions<1>;
        EXPECT_NEAR(speed_factor<one>(law, Lanes<one>::variable(v, 0)).slope[0], slopes[lane], 1e-12) << v;
    }
}

/// v + b m(v) = w, to what two steps of Newton's method leave of friction.
TEST(TipFactors, BrakedSpeedSolvesItsEquationOnFallingFriction) {
    const TipLaw law = law_of(SpeedProfile::through(std::vector{0.01, 0.5}, std::vector{1.0, 0.6}));
    for (const double w : {0.05, 0.1, 0.2, 0.4, 0.9}) {
        const double b = 0.03, v = braked_speed<1>(law, Lanes<1>(b), Lanes<1>(w), Lanes<1>(0.01))[0];
        EXPECT_NEAR(v + b * law.by_speed.at(v), w, 1e-3 * b) << w;
    }
}

TEST(TipLaw, IsAbsentUnlessAScenesNamesIt) {
    const Parameters p;
    EXPECT_EQ(tip_law(p, 300.0), nullptr);
}

TEST(TipLaw, ATableIsAShareOfItsLargestValue) {
    Parameters p;
    p.tip.friction_law = TipFriction::table;
    p.tip.friction_table = {{0.0, 1.0}, {0.09, 0.06}};
    EXPECT_EQ(tip_law(p, 300.0)->by_speed.at(0.0), 1.0);
    EXPECT_NEAR(tip_law(p, 300.0)->by_speed.at(1.0), 2.0 / 3.0, 1e-15);
    p.tip.friction_table = {{0.0, 0.1, 1.0}, {0.09, 0.09, 0.09}};
    for (const double v : {0.0, 0.05, 0.7, 3.0}) EXPECT_EQ(tip_law(p, 300.0)->by_speed.at(v), 1.0) << "a constant table: to the bit";
}

TEST(TipLaw, ViscosityFollowsItsTwoPointsAndFallsWithTheTemperature) {
    const Oil oil;
    EXPECT_NEAR(oil_viscosity(oil, 313.15), oil.viscosity_40, 1e-12);
    EXPECT_NEAR(oil_viscosity(oil, 373.15), oil.viscosity_100, 1e-12);
    const double middle = std::sqrt(oil.viscosity_40 * oil.viscosity_100);  // at 1/(θ + 95) half-way, θ = 64.5 °C
    EXPECT_NEAR(oil_viscosity(oil, 2.0 / (1.0 / 135.0 + 1.0 / 195.0) - 95.0 + 273.15), middle, 1e-9 * middle);
}

/// Hamrock and Dowson's central film of the baseline: 28 nm at 0.1 m/s and 40 °C with steel and 0.03 Pa·s, by hand.
TEST(TipLaw, FilmIsThatOfHamrockAndDowson) {
    const Parameters p;
    const double e = 2.1e11 / 0.91, r = std::pow(0.75 * 2.5e10 / (0.5 * e), 2), force = 2.5e10 * std::pow(9e-6, 1.5);
    const double h = 1.9 * std::pow(0.03 * 0.05 / (e * r), 0.67) * std::pow(1.8e-8 * e, 0.53) * std::pow(force / (e * r * r), -0.067) * r;
    EXPECT_NEAR(film_ratio(p, 0.1, 313.15), h / p.tip.roughness, 2e-3 * h / p.tip.roughness);  // 2.69 · 0.706 = 1.899
    EXPECT_GT(h, 15e-9);
    EXPECT_LT(h, 60e-9);
    EXPECT_NEAR(film_ratio(p, 0.2, 313.15) / film_ratio(p, 0.1, 313.15), std::pow(2.0, 0.67), 1e-12);
}

/// Boundary at rest, half-way in film share where (1 + Λ)² = 2, limiting traction at high speed; sixteen knots follow to 1 % of μ.
TEST(TipLaw, LubricatedFrictionFallsFromBoundaryToFilm) {
    Parameters p;
    p.tip.friction_law = TipFriction::lubricated;
    const double warm = 353.15, mu = p.tip.friction.coefficient;
    EXPECT_NEAR(lubricated_coefficient(p, 1e-9, warm), mu, 1e-5);
    EXPECT_NEAR(lubricated_coefficient(p, 1e6, warm), p.tip.limiting_traction, 1e-5);
    const double half = std::pow((std::sqrt(2.0) - 1.0) / film_ratio(p, 1.0, warm), 1.0 / 0.67);
    EXPECT_NEAR(lubricated_coefficient(p, half, warm), 0.5 * (mu + p.tip.limiting_traction), 1e-12);
    const auto law = tip_law(p, warm);
    for (double v = 1e-4; v < 1e3; v *= 1.1) EXPECT_NEAR(mu * law->by_speed.at(v), lubricated_coefficient(p, v, warm), 0.01 * mu) << v;
    EXPECT_LT(lubricated_coefficient(p, 0.5, 313.15), lubricated_coefficient(p, 0.5, 373.15)) << "thin oil, more contact";
}

/// Hertz: p = (6 N E*²/(π³ R²))^(1/3) of the same contact.
TEST(TipLaw, PressureIsThatOfHertz) {
    const Parameters p;
    const double e = contact_modulus(p), r = std::pow(0.75 * p.tip.hertz / e, 2), depth = 9e-6, force = p.tip.hertz * std::pow(depth, 1.5);
    const double pressure = std::cbrt(6.0 * force * e * e / (M_PI * M_PI * M_PI * r * r));
    EXPECT_NEAR(pressure_per_root_depth(p) * std::sqrt(depth), pressure, 1e-9 * pressure);
}

}  // namespace
}  // namespace cvtflow::model
