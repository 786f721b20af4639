/// Claim: the contact of tips and sheaves is Hertz's, its friction lets a pushed block creep, and a tip that flies onto a sheave arrives
/// once and on time.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "model/law/friction_laws.hpp"
#include "model/observe/observation.hpp"
#include "tests/claims/chain_view_fixture.hpp"
#include "tests/claims/rig_fixture.hpp"

namespace cvtflow::claims {
namespace {

/// A ring of 13 pins at rest around shaft 1 between its two rigid sheaves, nothing pressing or turning them.
/// @param level of detail but for the sheaves; "lumped": fine, with lumped plates
model::Parameters ring_between_sheaves(const std::string& level) {
    model::Parameters p;
    p.detail.plates = model::PlateDetail::lumped;
    if (level != "lumped") p = at_level(p, level);
    p.detail.pulleys = model::PulleyDetail::rigid;
    p.start.layout = model::StartLayout::ring;
    p.start.ring_speed = 0.0;
    p.start.settling_time = 0.0;
    p.chain.pins = 13;
    p.pulley.arc_position = 16.8e-3;  // the ring's radius, 13 pitches round
    p.pulley.innermost = 10e-3;
    p.pulley.outermost = 30e-3;
    p.drive.speed = model::TimeTable(0.0);
    p.load.torque = model::TimeTable(0.0);
    p.clamping = {model::TimeTable(0.0), model::TimeTable(0.0)};
    return p;
}

std::vector<std::string> levels_and_lumped() {
    std::vector<std::string> all = levels();
    all.emplace_back("lumped");
    return all;
}

class Contact : public testing::TestWithParam<std::string> {
protected:
    const model::Parameters p = ring_between_sheaves(GetParam());
    const model::ChainLayout at = model::layout_of(p);
    Rig rig{p};
    static constexpr std::array ends{model::End::rear, model::End::front};

    /// Moves the ring as it is, axially and along x, with the given velocity.
    void launch(Vector shift, Vector velocity) {
        for (int link = 0; link < at.links; ++link) {
            double* q = rig.mutable_state() + at.link_begin(link);
            for (const auto end : ends) {
                q[at.x(end, 0)] += shift.x;
                q[at.z(end)] += shift.z;
                q[at.link_size() + at.x(end, 0)] = velocity.x;
                q[at.link_size() + at.z(end)] = velocity.z;
            }
        }
    }
    [[nodiscard]] model::TipProbe probe(int link) const {
        model::SheaveMotion sheaves[4];
        rig.variator().pulleys().motions(rig.state() + at.pulley_begin(), sheaves);
        model::TipProbe found;
        model::NeighbourWindow strip;
        rig.variator().chain().probe(strip.of(at, rig.state(), link), sheaves, true, found);
        return found;
    }
    /// Centre of the sphere of a tip at side +z relative to the axis of shaft 1, by model/EQUATIONS.md section 6 (straight pins).
    [[nodiscard]] Vector sphere(int link, model::End end) const {
        const ChainView chain(p, rig.state());
        const Vector t = chain.direction(link);
        const double sine = std::sin(p.tip.angle), cosine = std::cos(p.tip.angle);
        return chain.position(link, end) +
               Vector{p.tip.radius * sine * t.y, -p.tip.radius * sine * t.x, 0.5 * p.half.length - p.tip.radius * cosine};
    }
    /// Centre of the meridian arc of the fixed or resting sheave at side +z: radius from the axis, height.
    struct Arc {
        double radius, height;
    };
    [[nodiscard]] Arc arc() const {
        const double w = rig.state()[at.pulley_begin() + 2];  // of the movable sheave 1+
        return {p.pulley.arc_position - p.pulley.arc_radius * std::sin(p.tip.angle),
                0.5 * p.half.length + w + p.pulley.arc_radius * std::cos(p.tip.angle)};
    }
    [[nodiscard]] double reach() const { return p.pulley.arc_radius + p.tip.radius; }
};

TEST_P(Contact, A700NewtonTipIsNineMicrometresDeepByHertz) {
    const double depth = std::pow(700.0 / p.tip.hertz, 2.0 / 3.0);
    EXPECT_NEAR(depth, 9e-6, 0.5e-6);
    double& w = rig.mutable_state()[at.pulley_begin() + 2];
    for (int iteration = 0; iteration < 40; ++iteration)
        w += probe(0).depth[1] - depth;  // moving the sheave by dw changes the depth by nearly dw
    ASSERT_NEAR(probe(0).depth[1], depth, 1e-15);
    std::vector<model::Phase> phases(static_cast<std::size_t>(4 * at.links), model::Phase::touching);
    model::EvaluationScratch scratch(at);
    model::fill_window(rig.variator(), rig.state(), scratch);
    rig.variator().pulleys().motions(rig.state() + at.pulley_begin(), scratch.sheaves);
    std::vector<double> slope(static_cast<std::size_t>(at.link_block()));
    model::LinkContact contact;
    rig.variator().chain().observed_slopes({0, 1, scratch.window.data(), scratch.sheaves, phases.data()}, slope.data(),
                                           scratch.loads.data(), scratch.accounts.data(), &contact);
    EXPECT_NEAR(contact.normal[1], 700.0, 1e-6);  // 1.5 · 700 N/9 µm · 1e-15 m = 1e-7 N
    EXPECT_NEAR(contact.normal[3], 700.0, 1e-6) << "the link is symmetric";
    // It leans by β at r_m; a millimetre away by 1 mm/R_c less, 0.07 N.
    EXPECT_NEAR(contact.axial[1], 700.0 * std::cos(p.tip.angle), 0.1);
}

TEST_P(Contact, ARingThatFliesAxiallyOntoASheaveArrivesWithAllTipsAtOneTime) {
    const double gap = 37e-6, speed = 0.8;
    rig.mutable_state()[at.pulley_begin() + 2] += 1e-3;  // opens the +z sheave
    launch({0.0, 0.0, 0.5e-3}, {0.0, 0.0, 0.0});         // away from the -z sheave
    const Vector s = sphere(0, model::End::rear);
    const double across =
        arc().height - std::sqrt(reach() * reach() - std::pow(std::hypot(s.x, s.y) - arc().radius, 2)) - s.z;  // until it touches
    launch({0.0, 0.0, across - gap}, {0.0, 0.0, speed});
    ASSERT_FALSE(rig.run({0.0, gap / speed + 2e-7, 5e-8, 1e-6}));
    ASSERT_EQ(rig.transitions().size(), ends.size() * static_cast<std::size_t>(at.links)) << "each half once, at +z only";
    for (const auto& event : rig.transitions()) {
        EXPECT_EQ(event.tip % 2, 1);
        EXPECT_EQ(event.to, model::Phase::touching);
        EXPECT_NEAR(event.time, gap / speed, 1e-14);  // lengths of 2 m are rounded to 4e-16 m; 1e-9 of the step is 5e-17 s
    }
    EXPECT_EQ(rig.counters().suppressed, 0);
}

/// When the sphere of a tip at +z first touches while the ring flies along x: |S_xy + u t| equals the radius at which the arc is reached.
double arrival(Vector s, double u, double touching_radius) {
    const double half = s.x * u, gone = s.x * s.x + s.y * s.y - touching_radius * touching_radius;
    const double root = half * half - u * u * gone;
    if (root < 0.0 || gone < 0.0) return 1e300;
    const double t = (-half - std::sqrt(root)) / (u * u);
    return t > 0.0 ? t : 1e300;
}

TEST_P(Contact, ARingThatFliesAlongXTouchesFirstWithTheTipThatIsDueAndOnce) {
    const double gap = 20e-6, speed = 2.0;
    rig.mutable_state()[at.pulley_begin() + 2] += gap;
    launch({0.0, 0.0, 0.8 * gap}, {0.0, 0.0, 0.0});  // clear of the -z sheave for longer
    launch({0.0, 0.0, 0.0}, {speed, 0.0, 0.0});
    double first = 1e300;
    int tip = -1;
    for (int link = 0; link < at.links; ++link) {
        for (const auto end : ends) {
            const Vector s = sphere(link, end);
            const double radius = arc().radius + std::sqrt(reach() * reach() - std::pow(s.z - arc().height, 2));
            const double t = arrival(s, speed, radius);
            if (t < first) first = t, tip = 4 * link + 2 * static_cast<int>(end) + 1;
        }
    }
    ASSERT_GT(first, 1e-6);
    ASSERT_LT(first, 1e-3);
    ASSERT_FALSE(rig.run({0.0, first + 1e-8, 5e-8, first + 1e-8}));
    ASSERT_EQ(rig.transitions().size(), 1u);
    EXPECT_EQ(rig.transitions()[0].tip, tip);
    EXPECT_NEAR(rig.transitions()[0].time, first, 1e-14);
    EXPECT_EQ(rig.counters().truncated, 1);
}

INSTANTIATE_TEST_SUITE_P(EveryLevel, Contact, testing::ValuesIn(levels_and_lumped()), [](const auto& level) { return level.param; });

TEST(Creep, ABlockPushedByLessThanItsFrictionCreepsAtTheShareOfTheSaturationSpeed) {
    const model::Friction friction{0.09, 0.01};
    const double normal = 700.0, mass = 8e-3;
    for (const double share : {0.1, 0.5, 0.9}) {
        const model::FrictionCurve curve(friction, {});
        const double push = share * friction.coefficient * normal;
        double v = 0.0;
        const double relaxation = mass * friction.saturation_speed / (friction.coefficient * normal);
        for (int step = 0; step < 400; ++step) {  // implicit midpoint would do no better: 0.1 relaxation times per step, 40 in all
            v += 0.1 * relaxation / mass * (push - curve.coefficient * normal * model::slip_factor<1>(curve, model::Lanes<1>(v))[0] * v);
        }
        EXPECT_NEAR(v, friction.saturation_speed * share, 1e-15);
    }
}

TEST(Creep, ARingDrivenByItsSheavesLagsByTheShareOfTheSaturationSpeed) {
    // With the whole model: a torque T on the shaft speeds up sheaves (I_s) and, through friction alone, the ring (I_r). So
    // friction passes on M = T I_r/(I_r + I_s) and needs the slip v0 M/(μ ΣN r), well below saturation.
    model::Parameters p = ring_between_sheaves("lumped");
    p.drive.mode = model::DriveMode::torque;
    p.drive.torque = model::TimeTable(4.0);
    p.clamping.driving = model::TimeTable(2000.0);
    p.pulley.shaft_polar_inertia = p.pulley.sheave_polar_inertia = 1e-5;
    p.chain.damping_ratio = 1.0;  // ends the ringing of the sudden start; damping takes no part in steady spin-up
    Rig rig(p);
    ASSERT_FALSE(rig.run({0.0, 2e-3, 5e-8, 1e-4}));
    model::Observer observer(rig.variator());
    const model::Observation& now = observer.observe(rig.time(), rig.state(), rig.phases().data());
    const ChainView chain(p, rig.state());
    const double ring = chain.angular_momentum() / chain.turning(0), sheaves = 3e-5;
    const double passed_on = 4.0 * ring / (ring + sheaves);
    EXPECT_NEAR(-now.chain_torque[0], passed_on, 1e-3 * passed_on);  // measured 6e-5
    const double normal = 2.0 * 2000.0 / std::cos(p.tip.angle), radius = norm(chain.pin(0));
    const double share = passed_on / (p.tip.friction.coefficient * normal * radius);
    ASSERT_LT(share, 0.7);
    model::SheaveMotion motion[4];
    rig.variator().pulleys().motions(rig.state() + rig.variator().layout().pulley_begin(), motion);
    double slip = 0.0;
    for (int link = 0; link < chain.links(); ++link) {
        model::TipProbe probe;
        rig.variator().chain().probe(rig.state() + rig.variator().layout().link_begin(link), motion, true, probe);
        for (const double tip : probe.slip) slip += tip / (4.0 * chain.links());
    }
    // Contact points lie some 0.4 mm inside the halves (R_p (1 - cos) of the links' lean), 2 % of the radius; measured 2.0 %.
    EXPECT_NEAR(slip, share * p.tip.friction.saturation_speed, 0.03 * share * p.tip.friction.saturation_speed);
}

}  // namespace
}  // namespace cvtflow::claims
