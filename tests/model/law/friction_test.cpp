#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "law_properties.hpp"
#include "model/law/friction.hpp"
#include "model/law/friction_laws.hpp"
#include "model/law/phase_rule.hpp"
#include "model/rigid/rigid_vectors.hpp"

namespace cvtflow::model {
namespace {

// Laws of friction: profiles over speed and factors of tips, the catalogue of laws, and friction that follows a remembered speed: the
// equation of that speed, and one contact on a spring at its limit of stability.

const std::vector<double> speeds{0.0, 0.01, 0.03, 0.3, 2.0}, values{0.5, 0.8, 1.0, 0.4, 0.4};

[[nodiscard]] TipLaw law_of(const SpeedProfile& profile) { return {.by_speed = profile}; }

/// Values between two points are within theirs, and keep their order. One-sided differences at every point, the ends included, tend to the
/// same slope as the step shrinks.
TEST(SpeedProfile, GoesThroughItsPointsMonotonouslyAndWithoutCornersAndIsConstantOutside) {
    const SpeedProfile profile = SpeedProfile::through(speeds, values);
    EXPECT_EQ(profile.at(100.0), profile.at(2.0));
    EXPECT_EQ(SpeedProfile::through(std::vector{0.1}, std::vector{0.7}).at(0.0), 0.7);
    for (std::size_t k = 0; k < speeds.size(); ++k) {
        const double at = speeds[k];
        EXPECT_NEAR(profile.at(at), values[k], 1e-15) << at;  // sums of gains
        for (const double step : {1e-4, 1e-5}) {
            const double right = (profile.at(at + step) - profile.at(at)) / step;
            const double left = at == 0.0 ? 0.0 : (profile.at(at) - profile.at(at - step)) / step;
            EXPECT_NEAR(left, right, 1.2e4 * step) << at;  // curvature: 2 (6 rise/width²), 0.3 over 0.01 m/s
        }
        if (k + 1 == speeds.size()) continue;
        const double sign = values[k + 1] >= values[k] ? 1.0 : -1.0;
        double before = profile.at(at);
        for (int i = 1; i <= 200; ++i) {
            const double now = profile.at(at + (speeds[k + 1] - at) * i / 200.0);
            EXPECT_GE(sign * (now - before), -1e-15) << k << " " << i;  // an ulp of 1
            before = now;
        }
    }
}

/// v + b m(v) = w, to the error of two steps of Newton's method.
TEST(TipFactors, BrakedSpeedSolvesItsEquationOnFallingFriction) {
    const TipLaw law = law_of(SpeedProfile::through(std::vector{0.01, 0.5}, std::vector{1.0, 0.6}));
    for (const double w : {0.05, 0.1, 0.2, 0.4, 0.9}) {
        const double b = 0.03, v = braked_speed<1>(law, Lanes<1>(b), Lanes<1>(w), Lanes<1>(0.01))[0];
        EXPECT_NEAR(v + b * law.by_speed.at(v), w, 1e-3 * b) << w;
    }
}

TEST(TipLaw, ATableIsAShareOfItsLargestValue) {
    Parameters p;
    EXPECT_EQ(tip_law(p, 300.0), nullptr) << "a scene that names none";
    p.tip.friction_law = TipFriction::table;
    p.tip.friction_table = {{0.0, 1.0}, {0.09, 0.06}};
    EXPECT_EQ(tip_law(p, 300.0)->by_speed.at(0.0), 1.0);
    EXPECT_NEAR(tip_law(p, 300.0)->by_speed.at(1.0), 2.0 / 3.0, 1e-15);
    p.tip.friction_table = {{0.0, 0.1, 1.0}, {0.09, 0.09, 0.09}};
    for (const double v : {0.0, 0.05, 0.7, 3.0}) EXPECT_EQ(tip_law(p, 300.0)->by_speed.at(v), 1.0) << "a constant table: to the bit";
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

TEST(FrictionLaws, AllOweTheSame) {
    for (std::size_t law = 0; law < friction_law_names.size(); ++law) {
        SCOPED_TRACE(friction_law_names[law]);
        for (const double d : {0.1, 0.5}) {
            Detail detail;
            detail.friction = static_cast<FrictionLaw>(law);
            detail.smoothing = d;
            expect_a_law<FrictionLaws>(FrictionCurve({0.09, 0.01}, detail));
        }
    }
}

constexpr double v0 = 0.01;

FrictionCurve smoothed(double half_width) {
    Detail detail;
    detail.friction = FrictionLaw::smoothed;
    detail.smoothing = half_width;
    return FrictionCurve({0.09, v0}, detail);
}
double slip_factor(const FrictionCurve& curve, double speed) { return model::slip_factor<1>(curve, Lanes<1>(speed))[0]; }
/// Share of the full friction, with the sign of the speed.
double share(const FrictionCurve& curve, double speed) { return slip_factor(curve, std::abs(speed)) * speed; }

TEST(Friction, SmoothedIsTheParabolaOfItsDefinition) {
    for (const double d : {0.002, 0.05, 0.1, 0.5, 0.9, 1.0}) {
        const FrictionCurve curve = smoothed(d);
        for (double u = 0.0; u < 3.0; u += 0.01) {
            EXPECT_EQ(share(curve, -u * v0), -share(curve, u * v0)) << u;
            const double expected = u <= 1.0 - d ? u : u >= 1.0 + d ? 1.0 : 1.0 - (1.0 + d - u) * (1.0 + d - u) / (4.0 * d);
            EXPECT_NEAR(share(curve, u * v0), expected, 2e-15) << u;
        }
    }
}

constexpr double resting = 0.01;  // v0 [m/s]

TipLaw falling_with_memory(double memory) {
    TipLaw law;
    law.by_speed = SpeedProfile::through(std::vector{0.02, 0.1}, std::vector{1.0, 0.5625});
    law.memory = memory;
    return law;
}

double remembered(const TipLaw& law, double step, double before, double speed) {
    return remembered_speed<1>(law, resting, step, Lanes<1>(before), Lanes<1>(speed))[0];
}

/// w' = (v + v0)(v - w)/L: e^-x to its third power of x.
TEST(RememberedSpeed, FollowsAConstantSpeedExponentially) {
    const TipLaw law = falling_with_memory(1e-6);
    for (const double before : {0.0, 0.03, 0.2}) {
        for (const double speed : {0.0, 0.05, 1.0}) {
            for (const double x : {1e-4, 1e-2, 0.1, 0.5}) {
                const double step = x * law.memory / (speed + resting), exact = speed + (before - speed) * std::exp(-x);
                EXPECT_NEAR(remembered(law, step, before, speed), exact, std::abs(before - speed) * x * x * x / 6.0 + 1e-15);
            }
        }
    }
}

/// A mass m on a spring k and a damper c, on a band of the speed V under the force N. Friction is -μ(w) N; a = (V + v0)/L, g = -N μ'(V):
///     m s³ + (m a + c) s² + (k + c a - g a) s + k a = 0
/// and by Routh stable up to g = c + c k/(a (m a + c)), where it oscillates with ω² = k a/(m a + c).
struct BandContact {
    double mass = 0.02, stiffness = 8e7, damping = 50.0, band = 0.06;  // kg, N/m, N s/m, m/s
    double coefficient = 0.16;
    TipLaw law;

    [[nodiscard]] double follows() const { return (band + resting) / law.memory; }
    [[nodiscard]] double limit() const {
        const double a = follows();
        return damping + damping * stiffness / (a * (mass * a + damping));
    }
    [[nodiscard]] double limit_frequency() const { return std::sqrt(stiffness * follows() / (mass * follows() + damping)); }
    /// Load with which friction falls by g [N].
    [[nodiscard]] double load(double g) const { return -g / (coefficient * speed_factor_slope<1>(law, Lanes<1>(band))[0]); }
};

struct Swing {
    double growth;     ///< [1/s]
    double frequency;  ///< [rad/s]
};

/// Steps as a rigid tip takes them: friction of the speed remembered so far, of the velocity that it leaves. From the steady deflection
/// with a velocity of 1e-6 of the band's.
Swing swing_of(const BandContact& contact, double g) {
    const FrictionCurve curve({contact.coefficient, resting}, {});
    const double load = contact.load(g), full = contact.coefficient * load;
    const double period = 2.0 * std::numbers::pi * std::sqrt(contact.mass / contact.stiffness), h = period / 1000.0, r = h / contact.mass;
    const double steady = full * contact.law.by_speed.at(contact.band) / contact.stiffness;
    double x = steady, v = 1e-6 * contact.band, w = contact.band;
    std::vector<double> crossings, peaks{0.0};
    for (long step = 0; step < 120'000; ++step) {
        const double slip = v - contact.band, before = v;
        w = remembered(contact.law, h, w, std::abs(slip));
        const double free = slip - r * (contact.stiffness * x + contact.damping * v);
        const Lanes<1> capacity = full * speed_factor<1>(contact.law, Lanes<1>(w));
        v = contact.band + free * (1.0 - r * friction_factor<1>(curve, capacity, Lanes<1>(r), Lanes<1>(std::abs(free)))[0]);
        x += h * v;
        peaks.back() = std::max(peaks.back(), std::abs(v));
        if (before < 0.0 && v >= 0.0) {
            crossings.push_back(h * (static_cast<double>(step) - v / (v - before)));
            peaks.push_back(0.0);
        }
    }
    const std::size_t first = 40, last = crossings.size() - 2;  // peaks[k] is before crossing k
    const double time = crossings[last] - crossings[first];
    return {std::log(peaks[last] / peaks[first]) / time, 2.0 * std::numbers::pi * static_cast<double>(last - first) / time};
}

/// Memories from far shorter to far longer than the distance within a radian of the oscillation, 1 um.
TEST(FrictionMemory, OfOneContactOnASpringHasRouthsLimitAndItsFrequency) {
    for (const double memory : {1e-7, 1e-6, 1e-5}) {
        BandContact contact;
        contact.law = falling_with_memory(memory);
        const double limit = contact.limit();
        const Swing below = swing_of(contact, 0.9 * limit), above = swing_of(contact, 1.1 * limit);
        EXPECT_LT(below.growth, 0.0) << memory;
        EXPECT_GT(above.growth, 0.0) << memory;
        const double found = limit * (0.9 - 0.2 * below.growth / (above.growth - below.growth));
        const double frequency = 0.5 * (below.frequency + above.frequency);
        const std::string at = "_at_" + std::to_string(std::lround(1e9 * memory)) + "_nm";
        RecordProperty("limit" + at, std::to_string(found / limit));
        RecordProperty("frequency" + at, std::to_string(frequency / contact.limit_frequency()));
        EXPECT_NEAR(found, limit, 0.01 * limit) << memory;
        EXPECT_NEAR(frequency, contact.limit_frequency(), 0.002 * contact.limit_frequency()) << memory;
    }
}

constexpr double saturation = 0.01;

PhaseRule rule(bool stick_slip) {
    PhaseRule r;
    r.saturation_speed = saturation;
    r.stick_slip = stick_slip;
    return r;
}

TEST(PhaseRule, ATipTouchesAsSoonAsItHasDepthAndLeavesBeyondTheRelease) {
    const PhaseRule r = rule(false);
    EXPECT_EQ(r.next(Phase::free, {1e-15, 0.0}), Phase::touching);
    EXPECT_EQ(r.next(Phase::free, {0.0, 0.0}), Phase::free);
    EXPECT_EQ(r.next(Phase::free, {-1e-15, 0.0}), Phase::free);
    EXPECT_EQ(r.next(Phase::touching, {-0.5 * r.release, 0.0}), Phase::touching);
    EXPECT_EQ(r.next(Phase::touching, {-1.5 * r.release, 0.0}), Phase::free);
    EXPECT_EQ(r.next(Phase::touching, {1e-6, 100.0}), Phase::touching);
}

TEST(PhaseRule, StickAndSlipAreToldBySpeedOnlyIfAskedFor) {
    const PhaseRule r = rule(true);
    EXPECT_EQ(r.next(Phase::free, {1e-9, 0.5 * saturation}), Phase::stick);
    EXPECT_EQ(r.next(Phase::free, {1e-9, 1.5 * saturation}), Phase::slip);
    EXPECT_EQ(r.next(Phase::stick, {1e-9, 1.01 * saturation}), Phase::slip);
    EXPECT_EQ(r.next(Phase::slip, {1e-9, 0.99 * saturation}), Phase::stick);
    for (const Phase phase : {Phase::stick, Phase::slip}) EXPECT_EQ(r.next(phase, {-2e-9, saturation}), Phase::free);
}

TEST(PhaseRule, NoTipFlipsBackAtOnce) {
    for (const bool stick_slip : {false, true}) {
        const PhaseRule r = rule(stick_slip);
        for (const double depth : {-3e-9, -1e-9, -1e-12, 0.0, 1e-12, 1e-6}) {
            for (const double slip : {0.0, 0.9999995 * saturation, saturation, 1.0000005 * saturation, 2.0 * saturation}) {
                for (const Phase phase : {Phase::free, Phase::touching, Phase::stick, Phase::slip}) {
                    if (!stick_slip && (phase == Phase::stick || phase == Phase::slip)) continue;
                    const Phase next = r.next(phase, {depth, slip});
                    EXPECT_EQ(r.next(next, {depth, slip}), next) << "depth " << depth << ", slip " << slip;
                }
            }
        }
    }
}

TEST(PhaseRule, TheGapFunctionIsPositiveExactlyWhereTheTransitionIsDue) {
    for (const bool stick_slip : {false, true}) {
        const PhaseRule r = rule(stick_slip);
        for (const double depth : {-3e-9, -2e-9, -5e-10, -1e-12, 1e-12, 1e-6}) {
            for (const double slip : {0.0, 0.999 * saturation, 1.001 * saturation, 2.0 * saturation}) {
                for (const Phase phase : {Phase::free, Phase::touching, Phase::stick, Phase::slip}) {
                    const TipIndicator tip{depth, slip};
                    const Phase next = r.next(phase, tip);
                    if (next != phase) {
                        EXPECT_GT(r.due(phase, next, tip), 0.0);
                    }
                }
                EXPECT_EQ(r.next(Phase::free, {depth, slip}) != Phase::free, r.due(Phase::free, Phase::touching, {depth, slip}) > 0.0);
                EXPECT_EQ(r.next(Phase::touching, {depth, slip}) == Phase::free, r.due(Phase::touching, Phase::free, {depth, slip}) > 0.0);
            }
        }
    }
}

}  // namespace
}  // namespace cvtflow::model
