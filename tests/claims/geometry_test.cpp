/// Claim: the chain starts closed around its pulleys, with joints and plates exactly as deep and long as requested.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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
    model::Parameters p = free_ring(pins);
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

/// A start as it was placed.
struct Placed {
    explicit Placed(const model::Parameters& parameters) : p(parameters), start(model::start_state(p)) {}

    const model::Parameters& p;
    const model::StartState start;
    const ChainView chain{p, start.state.data()};
};

void expect_joints_and_plates_of_their_pretension(const Placed& at) {
    const double pull = pretension(at.p);
    double closing = 0.0, stretching = 0.0;
    for (int link = 0; link < at.chain.links(); ++link) {
        EXPECT_NEAR(at.chain.joint_depth(link), pull / at.p.joint.stiffness, 1e-12) << "pin " << link;
        EXPECT_NEAR(at.chain.stretch(link), pull / (at.p.plate.count * at.p.plate.stiffness), 1e-12) << "link " << link;
        closing = std::max(closing, std::abs(at.chain.joint_closing(link)));
        stretching = std::max(stretching, std::abs(at.chain.stretching(link)));
    }
    // Velocities are differences of two placements 2e-3 pitches apart: second order in them, and first order where a strand meets an arc.
    // Measured up to 2.5e-7 and 4.3e-7 m/s at 15 m/s; a stiff contact would answer 1 um/s with some millinewtons.
    EXPECT_LT(closing, 1e-7 * std::max(at.start.speed, 5.0));
    EXPECT_LT(stretching, 1e-7 * std::max(at.start.speed, 5.0));
}

void expect_pins_on_one_circle_per_pulley_and_on_the_tangents_between(const Placed& at) {
    const double r1 = at.start.radii.driving, r2 = at.start.radii.driven, a = at.p.pulley.centre_distance;
    const bool is_ring = at.p.start.layout == model::StartLayout::ring;
    const double sine = is_ring ? 0.0 : (r2 - r1) / a, cosine = std::sqrt(1.0 - sine * sine);
    int counted[3] = {0, 0, 0};
    for (int pin = 0; pin < at.chain.links(); ++pin) {
        const Vector place = at.chain.pin(pin);
        if (is_ring || place.x <= -r1 * sine) {
            EXPECT_NEAR(std::hypot(place.x, place.y), r1, 1e-12);
            ++counted[0];
        } else if (place.x >= a - r2 * sine) {
            EXPECT_NEAR(std::hypot(place.x - a, place.y), r2, 1e-12);
            ++counted[1];
        } else {
            EXPECT_NEAR(-place.x * sine + std::abs(place.y) * cosine, r1, 1e-12);  // distance of the tangent from the driving axis
            ++counted[2];
        }
    }
    EXPECT_GT(counted[0], 0);
    EXPECT_TRUE(is_ring || counted[1] * counted[2] > 0);
}

void expect_deepest_tip_just_touching_each_sheave(const Placed& at) {
    const model::ChainModel model = model::make_chain(at.p);
    const model::PulleyModel pulleys(at.p);
    model::SheaveMotion sheaves[4];
    pulleys.motions(at.start.state.data() + model.layout().pulley_begin(), sheaves);
    double deepest[4] = {-1.0, -1.0, -1.0, -1.0};
    for (int link = 0; link < at.chain.links(); ++link) {
        const double* block = at.start.state.data() + model.layout().link_begin(link);
        model::TipProbe probe;
        model::NeighbourWindow strip;
        model.probe(strip.of(model.layout(), at.start.state.data(), link), sheaves, false, probe);
        const int shaft = model.shaft_of(block);
        for (int tip = 0; tip < model::tips_per_link; ++tip)
            deepest[2 * shaft + tip % 2] = std::max(deepest[2 * shaft + tip % 2], probe.depth[tip]);
    }
    for (const double depth : deepest) EXPECT_NEAR(depth, 0.0, 1e-12);
    for (const model::Phase phase : at.start.phases) EXPECT_EQ(phase, model::Phase::free);
}

TEST(GeometricStart, IsClosedAndPlacedAsRequested) {
    for (const Start& row : starts()) {
        SCOPED_TRACE(row.name);
        const Placed at(row.parameters);
        expect_joints_and_plates_of_their_pretension(at);
        expect_pins_on_one_circle_per_pulley_and_on_the_tangents_between(at);
        if (at.p.detail.pulleys != model::PulleyDetail::absent) expect_deepest_tip_just_touching_each_sheave(at);
    }
}

/// Rigid pins have plates and joints in series in a link; halves have a separate depth for each.
TEST(GeometricStart, CarriesItsPretensionInEveryLinkAtEveryLevel) {
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
