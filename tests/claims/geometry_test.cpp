/// Claim: the chain starts closed around its pulleys, with joints and plates exactly as deep and long as requested.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "model/machine/belt.hpp"
#include "model/observe/observation.hpp"
#include "model/start/start_state.hpp"
#include "model/variator/variator.hpp"
#include "tests/claims/chain_view_fixture.hpp"
#include "tests/claims/rig_fixture.hpp"

namespace cvtflow::claims {
namespace {

constexpr double pi = std::numbers::pi;

struct Start {
    std::string name;
    model::Parameters parameters;
};

model::Parameters around_pulleys(double ratio, std::vector<double> pitch) {
    model::Parameters p;
    p.start.ratio = ratio;
    p.chain.pitch = std::move(pitch);
    return p;
}

model::Parameters ring(int pins, std::vector<double> pitch) {
    model::Parameters p;
    p.detail.pulleys = model::PulleyDetail::absent;
    p.start.layout = model::StartLayout::ring;
    p.chain.pins = pins;
    p.chain.pitch = std::move(pitch);
    return p;
}

std::vector<Start> starts() {
    std::vector<Start> all;
    const std::vector<std::vector<double>> pitches{{8.12e-3}, {8.4e-3, 7.6e-3, 8.12e-3, 8.12e-3, 7.9e-3}};
    for (const auto& pitch : pitches) {
        const std::string mixed = pitch.size() == 1 ? "" : "Mixed";
        for (const double ratio : {0.417, 0.6, 0.8, 1.0, 1.3, 1.8, 2.4}) {
            all.push_back({"Ratio" + std::to_string(static_cast<int>(1000 * ratio)) + mixed, around_pulleys(ratio, pitch)});
        }
        for (const int pins : {3, 4, 5, 7, 12, 24, 84, 200}) all.push_back({"Ring" + std::to_string(pins) + mixed, ring(pins, pitch)});
        for (const std::string& level : levels()) {
            for (const double ratio : {0.417, 1.0, 2.4})
                all.push_back({"Ratio" + std::to_string(static_cast<int>(1000 * ratio)) + mixed + level,
                               at_level(around_pulleys(ratio, pitch), level)});
            for (const int pins : {3, 12})
                all.push_back({"Ring" + std::to_string(pins) + mixed + level, at_level(ring(pins, pitch), level)});
        }
    }
    return all;
}

/// Centrifugal pull σ v², for which the start is pre-tensioned: by the nominal belt.
double pretension(const model::Parameters& p) {
    double length = 0.0;
    for (int link = 0; link < p.chain.pins; ++link) length += p.chain.pitch[static_cast<std::size_t>(link) % p.chain.pitch.size()];
    const bool is_ring = p.start.layout == model::StartLayout::ring;
    const double radius = is_ring ? length / (2.0 * pi) : model::belt_radii(length, p.start.ratio, p.pulley.centre_distance)->driving;
    const double speed = radius * (is_ring ? p.start.ring_speed : p.drive.speed.at(0.0));
    return model::link_mass(p) * p.chain.pins / length * speed * speed;
}

TEST(BeltGeometry, AtRatioOneTheRadiusIs54MillimetresAndTheWrapsAreHalfCircles) {
    const double length = 84 * 8.12e-3;
    const auto radii = model::belt_radii(length, 1.0, 0.170);
    ASSERT_TRUE(radii.has_value());
    EXPECT_NEAR(radii->driving, (length - 2.0 * 0.170) / (2.0 * pi), 1e-16);
    EXPECT_NEAR(radii->driving, 54.444e-3, 5e-7);  // as rounded in the design
    EXPECT_NEAR(radii->driven, radii->driving, 1e-17);
}

TEST(BeltGeometry, AtRatio24RadiiAndWrapsAreThoseOfTheOpenBelt) {
    const double a = 0.170;
    const auto radii = model::belt_radii(84 * 8.12e-3, 2.4, a);
    ASSERT_TRUE(radii.has_value());
    const double lean = std::asin((radii->driven - radii->driving) / a);
    EXPECT_NEAR(radii->driving, 30.984e-3, 5e-7);
    EXPECT_NEAR(radii->driven, 74.361e-3, 5e-7);
    EXPECT_NEAR(180.0 - lean * 360.0 / pi, 150.43, 5e-3);
    EXPECT_NEAR(180.0 + lean * 360.0 / pi, 209.57, 5e-3);
    // Length put together from its pieces: two strands and two arcs.
    const double pieces = 2.0 * std::sqrt(a * a - std::pow(radii->driven - radii->driving, 2)) + radii->driving * (pi - 2.0 * lean) +
                          radii->driven * (pi + 2.0 * lean);
    EXPECT_NEAR(model::belt_length(*radii, a), pieces, 1e-15);
    EXPECT_NEAR(pieces, 84 * 8.12e-3, 1e-15);
}

/// Made once, for all tests.
const model::StartState& started(const Start& row) {
    static std::map<std::string, model::StartState> made;
    const auto there = made.find(row.name);
    return there != made.end() ? there->second : made.emplace(row.name, model::start_state(row.parameters)).first->second;
}

class GeometricStart : public testing::TestWithParam<Start> {
protected:
    const model::Parameters& p = GetParam().parameters;
    const model::StartState& start = started(GetParam());
    const ChainView chain{p, start.state.data()};
    const double pull = pretension(p);
};

TEST_P(GeometricStart, EveryJointHasTheDepthOfItsPretension) {
    for (int pin = 0; pin < chain.links(); ++pin) EXPECT_NEAR(chain.joint_depth(pin), pull / p.joint.stiffness, 1e-12) << "pin " << pin;
}

TEST_P(GeometricStart, EveryPlateHasTheLengthOfItsPretension) {
    for (int link = 0; link < chain.links(); ++link) {
        EXPECT_NEAR(chain.stretch(link), pull / (p.plate.count * p.plate.stiffness), 1e-12) << "link " << link;
    }
}

/// Rigid pins have plates and joints in series in a link; halves have a separate depth for each.
TEST(GeometricStartOfEveryLevel, CarriesItsPretensionInEveryLink) {
    std::vector<std::string> all = levels();
    all.emplace_back("rigid");
    const std::vector<double> pitch{8.12e-3};
    for (const std::string& level : all) {
        for (const model::Parameters& machine : {ring(84, pitch), around_pulleys(1.0, pitch), around_pulleys(2.4, pitch)}) {
            const model::Parameters p = at_level(machine, level);
            const model::StartState start = model::start_state(p);
            const model::Variator variator(p);
            model::Observer observer(variator);
            const double expected = pretension(p);  // 1e-12 m of 1e9 N/m are a millinewton, lengths are found to 1e-14 m
            for (const double tension : observer.observe(0.0, start.state.data(), start.phases.data()).tension)
                ASSERT_NEAR(tension, expected, 1e-3) << level << " at ratio " << p.start.ratio;
        }
    }
}

TEST_P(GeometricStart, PinsLieOnOneCirclePerPulleyAndOnTheTangentsBetween) {
    const double r1 = start.radii.driving, r2 = start.radii.driven, a = p.pulley.centre_distance;
    const bool is_ring = p.start.layout == model::StartLayout::ring;
    const double sine = is_ring ? 0.0 : (r2 - r1) / a, cosine = std::sqrt(1.0 - sine * sine);
    int counted[3] = {0, 0, 0};
    for (int pin = 0; pin < chain.links(); ++pin) {
        const Vector at = chain.pin(pin);
        if (is_ring || at.x <= -r1 * sine) {
            EXPECT_NEAR(std::hypot(at.x, at.y), r1, 1e-12);
            ++counted[0];
        } else if (at.x >= a - r2 * sine) {
            EXPECT_NEAR(std::hypot(at.x - a, at.y), r2, 1e-12);
            ++counted[1];
        } else {
            EXPECT_NEAR(-at.x * sine + std::abs(at.y) * cosine, r1, 1e-12);  // distance of the tangent from the driving axis
            ++counted[2];
        }
    }
    EXPECT_GT(counted[0], 0);
    if (!is_ring) {
        EXPECT_GT(counted[1] * counted[2], 0);
    }
}

TEST_P(GeometricStart, VelocitiesNeitherCloseJointsNorStretchPlates) {
    double closing = 0.0, stretching = 0.0;
    for (int link = 0; link < chain.links(); ++link) {
        closing = std::max(closing, std::abs(chain.joint_closing(link)));
        stretching = std::max(stretching, std::abs(chain.stretching(link)));
    }
    // Differences of two placements 2e-3 pitches apart: second order in them, and first order where a strand meets an arc. Measured up to
    // 2.5e-7 and 4.3e-7 m/s at 15 m/s; a stiff contact would answer 1 um/s with some millinewtons.
    EXPECT_LT(closing, 1e-7 * std::max(start.speed, 5.0));
    EXPECT_LT(stretching, 1e-7 * std::max(start.speed, 5.0));
}

TEST_P(GeometricStart, TheDeepestTipJustTouchesEachSheave) {
    if (p.detail.pulleys == model::PulleyDetail::absent) return;
    const model::ChainModel model = model::make_chain(p);
    const model::PulleyModel pulleys(p);
    model::SheaveMotion sheaves[4];
    pulleys.motions(start.state.data() + model.layout().pulley_begin(), sheaves);
    double deepest[4] = {-1.0, -1.0, -1.0, -1.0};
    for (int link = 0; link < chain.links(); ++link) {
        const double* block = start.state.data() + model.layout().link_begin(link);
        model::TipProbe probe;
        model::NeighbourWindow strip;
        model.probe(strip.of(model.layout(), start.state.data(), link), sheaves, false, probe);
        const int shaft = model.shaft_of(block);
        for (int tip = 0; tip < model::tips_per_link; ++tip)
            deepest[2 * shaft + tip % 2] = std::max(deepest[2 * shaft + tip % 2], probe.depth[tip]);
    }
    for (const double depth : deepest) EXPECT_NEAR(depth, 0.0, 1e-12);
    for (const model::Phase phase : start.phases) EXPECT_EQ(phase, model::Phase::free);
}

INSTANTIATE_TEST_SUITE_P(Chain, GeometricStart, testing::ValuesIn(starts()), [](const auto& instance) { return instance.param.name; });

TEST(GeometricStart, IsRefusedWhereTheChainDoesNotFit) {
    model::Parameters p;
    p.chain.pins = 60;
    p.start.ratio = 20.0;  // leaves a driving radius of 2 mm for links of 8 mm
    EXPECT_NO_THROW(static_cast<void>(model::start_state(around_pulleys(2.4, {8.12e-3}))));
    EXPECT_THROW(static_cast<void>(model::start_state(p)), std::invalid_argument);
    p.start.ratio = 1.0;
    p.chain.pins = 40;  // 325 mm: shorter than twice the centre distance
    EXPECT_THROW(static_cast<void>(model::start_state(p)), std::invalid_argument);
    p.chain.pins = 200;  // 1624 mm: the pulleys would have to overlap
    EXPECT_THROW(static_cast<void>(model::start_state(p)), std::invalid_argument);
}

TEST(GeometricStart, ReportsThatARingHasNoPulleys) {
    model::Parameters p = ring(3, {8e-3, 10e-3, 9e-3});  // a triangle more uneven than those above
    try {
        static_cast<void>(model::start_state(p));
        FAIL() << "it was closed";
    } catch (const std::invalid_argument& error) {
        EXPECT_STREQ(error.what(), "start: the chain cannot be closed into a ring with its joints rolling");
    }
}

/// A ring of N links of mass m on springs K has no radius at which it turns with Ω > 2π/N √(K/m): its tension grows faster than Hooke's
/// law.
TEST(GeometricStart, IsRefusedWhereTheRingBursts) {
    model::Parameters p = ring(84, {8.12e-3});
    const double mass = 2.0 * p.half.mass + p.plate.count * p.plate.mass, stiffness = p.plate.count * p.plate.stiffness;
    const double bursting = 2.0 * pi / p.chain.pins * std::sqrt(stiffness / mass);
    p.start.ring_speed = 0.2 * bursting;
    EXPECT_NO_THROW(static_cast<void>(model::start_state(p)));
    p.start.ring_speed = 1.001 * bursting;
    EXPECT_THROW(static_cast<void>(model::start_state(p)), std::invalid_argument);
}

}  // namespace
}  // namespace cvtflow::claims
