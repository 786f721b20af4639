/// Friction that follows a remembered speed: the speed's own equation, and one contact on a spring at its limit of stability.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "model/basis/native_lanes.hpp"
#include "model/law/friction_laws.hpp"
#include "model/rigid/rigid_vectors.hpp"

namespace cvtflow::model {
namespace {

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

TEST(RememberedSpeed, StaysBetweenTheFormerAndThePresentSpeedAndStaysWhereBothAreEqual) {
    for (const double memory : {1e-30, 1e-9, 1e-6, 1e-2}) {
        const TipLaw law = falling_with_memory(memory);
        for (const double step : {1e-9, 1e-6, 1.0}) {
            constexpr int single = singles<8>;
            const Lanes<single> both = remembered_speed<single>(law, resting, step, Lanes<single>(0.3), Lanes<single>(0.1));
            EXPECT_GE(widen<8>(both)[0], 0.1f * (1.0f - 1e-6f)) << memory << " " << step;
            EXPECT_LE(widen<8>(both)[0], 0.3f) << memory << " " << step;
            EXPECT_EQ(remembered(law, step, 0.07, 0.07), 0.07);
        }
    }
    EXPECT_NEAR(remembered(falling_with_memory(1e-30), 1e-6, 0.3, 0.1), 0.1, 1e-9) << "without a memory it is the speed";
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
    /// With which friction falls by g [N].
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

/// At once the limit is g = c: what memory stabilises.
TEST(FrictionMemory, MakesFallingFrictionStableThatIsUnstableAtOnce) {
    BandContact contact;
    contact.law = falling_with_memory(1e-5);
    const double g = 3.0 * contact.damping;
    ASSERT_LT(g, contact.limit());
    EXPECT_LT(swing_of(contact, g).growth, 0.0);
    contact.law.memory = 1e-9;
    EXPECT_GT(swing_of(contact, g).growth, 0.0);
}

}  // namespace
}  // namespace cvtflow::model
