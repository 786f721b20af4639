/// Runs that cannot continue report the fault, its time and its place.

#include "tasks/step/fault.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/claims/rig_fixture.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

using claims::Rig;

void expect_state_before(const Rig& rig, const Fault& fault) {
    for (int k = 0; k < rig.variator().layout().size(); ++k) ASSERT_TRUE(std::isfinite(rig.state()[k])) << "the last accepted state stays";
    EXPECT_GT(fault.time, rig.time());  // found at the end of the step that was not accepted
}

TEST(Faults, AStepFarTooLongForTheChainIsReportedAtItsPin) {
    Rig rig(tiny_parameters());
    const Fault fault = rig.run({settling_begin, 0.0, 5e-6, 5e-6});  // a hundred times the stable step
    EXPECT_TRUE(fault.kind == FaultKind::non_finite || fault.kind == FaultKind::left_sheave || fault.kind == FaultKind::penetration ||
                fault.kind == FaultKind::blow_up)
        << fault.message();
    EXPECT_GE(fault.pin, 0) << fault.message();
    EXPECT_LT(fault.time, 0.0);
    expect_state_before(rig, fault);
}

/// A speed along z of link 7. Each of the four stages carries what is not finite to one link more on each side. Pulleys would not be finite
/// either, and come first: that row has none.
TEST(Faults, ALinkThatIsNotFiniteOrFasterThanSoundIsNamed) {
    for (const double speed : {std::numeric_limits<double>::infinity(), 2e5}) {
        const bool finite = std::isfinite(speed);
        model::Parameters p = tiny_parameters();
        if (!finite) {
            p.detail.pulleys = model::PulleyDetail::absent;
            p.start.layout = model::StartLayout::ring;
        }
        Rig rig(p);
        const model::ChainLayout& at = rig.variator().layout();
        rig.mutable_state()[at.link_begin(7) + at.link_size() + at.z(model::End::rear)] = speed;
        const Fault fault = rig.run({settling_begin, 0.0, 5e-8, 1e-5});
        EXPECT_EQ(fault.kind, finite ? FaultKind::blow_up : FaultKind::non_finite) << fault.message();
        EXPECT_DOUBLE_EQ(fault.time, settling_begin + 5e-8);
        EXPECT_GE(fault.pin, 3);
        EXPECT_LE(fault.pin, 11);
        if (!finite) continue;
        EXPECT_EQ(fault.limit, 1e4);
        EXPECT_GT(fault.value, 1e4);
        expect_state_before(rig, fault);
    }
}

TEST(Faults, PulleysThatAreNotFiniteAreNamed) {
    model::Parameters p = tiny_parameters();
    p.detail.pulleys = model::PulleyDetail::rigid;
    Rig rig(p);
    rig.mutable_state()[rig.variator().layout().pulley_begin() + 4] = std::numeric_limits<double>::infinity();  // speed of shaft 1
    const Fault fault = rig.run({settling_begin, 0.0, 5e-8, 1e-5});
    EXPECT_EQ(fault.kind, FaultKind::non_finite);
    EXPECT_FALSE(fault.pin) << fault.message();
    EXPECT_NE(fault.message().find("pulleys"), std::string::npos);
}

TEST(Faults, APenetrationBeyondTheLimitIsReportedWithDepthAndPin) {
    model::Parameters p = tiny_parameters();
    p.tip.deepest = 2e-6;  // the settled variator needs about 9 µm
    Rig rig(p);
    const Fault fault = rig.run({settling_begin, 0.0, 5e-8, 1e-4});
    ASSERT_EQ(fault.kind, FaultKind::penetration) << fault.message();
    EXPECT_NE(fault.message().find("damping of the contacts too small (chain.damping_ratio)"), std::string::npos)
        << "clamping alone is not to blame";
    EXPECT_GT(fault.value, 2e-6);
    EXPECT_LT(fault.value, 2.1e-6) << "found in the step in which it happens";
    EXPECT_EQ(fault.limit, 2e-6);
    EXPECT_GE(fault.pin, 0);
    EXPECT_LT(fault.pin, p.chain.pins);
    expect_state_before(rig, fault);
}

/// The arcs lie on 16 mm, links' middles a little inside.
TEST(Faults, APinInsideTheSheaveOrATouchingOneOutsideIsReportedWithItsRadius) {
    for (const double limit : {15.9e-3, 15e-3}) {
        const bool inside = limit == 15.9e-3;
        model::Parameters p = tiny_parameters();
        (inside ? p.pulley.innermost : p.pulley.outermost) = limit;
        Rig rig(p);
        const Fault fault = rig.run({settling_begin, 0.0, 5e-8, 1e-4});
        ASSERT_EQ(fault.kind, FaultKind::left_sheave) << fault.message();
        EXPECT_EQ(fault.value < limit, inside);
        EXPECT_GT(fault.value, 14e-3);
        EXPECT_LT(fault.value, 17e-3);
        EXPECT_EQ(fault.limit, limit);
        EXPECT_GE(fault.pin, 0);
    }
}

TEST(Faults, EachHasANameAndAMessage) {
    for (const FaultKind kind :
         {FaultKind::non_finite, FaultKind::penetration, FaultKind::left_sheave, FaultKind::max_steps, FaultKind::max_wall,
          FaultKind::cancelled, FaultKind::blow_up, FaultKind::step_too_short, FaultKind::not_steady}) {
        const Fault fault{kind, 1.5e-3, 12, 1e-3, 2e-3};
        EXPECT_TRUE(static_cast<bool>(fault));
        EXPECT_EQ(fault.name() == "non_finite", kind == FaultKind::non_finite);
        EXPECT_NE(fault.name(), "unknown");
        EXPECT_NE(fault.message().find("0.0015 s"), std::string::npos) << fault.message();
    }
    EXPECT_FALSE(static_cast<bool>(Fault{}));
}

TEST(FaultText, ReportsWhatBlewUpAndWhichStepIsLost) {
    EXPECT_EQ(
        (Fault{FaultKind::blow_up, 1e-3, 7, 2.5e4, 1e4}).message(),
        "pin 7 moves at 2.5e+04 m/s at t = 0.001 s (limit 1e+04 m/s, faster than sound in steel): the step is too long for this scene");
    EXPECT_EQ((Fault{FaultKind::step_too_short, 1e4, {}, 1e-12, 2.2e-9}).message(),
              "a step of 1e-12 s is lost in the rounding of the time at t = 10000 s (limit 2.2e-09 s)");
}

}  // namespace
}  // namespace cvtflow::tasks
