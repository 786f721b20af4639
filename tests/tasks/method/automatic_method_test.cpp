/// Meaning of run.method = "auto", by detail and friction law; it is resolved wherever a method is named.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tasks/method/method.hpp"
#include "tasks/run/simulation.hpp"
#include "tests/claims/operating_point_fixture.hpp"

namespace cvtflow::tasks {
namespace {

std::string automatic_with(const std::vector<std::string>& settings) {
    std::vector<std::string> all{"start.state=", "start.settling_time=0", "start.ramp_time=1us", "run.method=auto"};
    all.insert(all.end(), settings.begin(), settings.end());
    return method_of(claims::ready_scene("tiny", all));
}

TEST(AutomaticMethod, IsChosenByDetailAndFrictionLaw) {
    EXPECT_EQ(automatic_with({}), "leapfrog-sweep");
    EXPECT_EQ(automatic_with({"detail.order=3", "detail.plates=each", "detail.joint_points=8"}), "leapfrog-sweep");
    EXPECT_EQ(automatic_with({"detail.pins=rigid", "detail.order=2"}), "leapfrog-rigid");
    EXPECT_EQ(automatic_with({"detail.pins=rigid", "detail.order=2", "detail.friction=smoothed"}), "leapfrog-rigid");
    EXPECT_EQ(automatic_with({"detail.friction=smoothed"}), "leapfrog-chebyshev");
    EXPECT_EQ(automatic_with({"detail.stick_slip=true"}), "leapfrog-chebyshev");
}

/// A tenth of the usual speeds takes five sweeps; a thousandth would take more than a step has.
TEST(AutomaticMethod, LeavesLowSaturationSpeedsToStages) {
    EXPECT_EQ(automatic_with({"tip.saturation_speed=1e-3", "joint.saturation_speed=5e-4", "plate.saturation_speed=1e-3"}),
              "leapfrog-sweep");
    EXPECT_EQ(automatic_with({"tip.saturation_speed=1e-5"}), "leapfrog-chebyshev");
}

TEST(AutomaticMethod, HasRowsOfTheCatalogueOfWhichTheLastSuitsEveryMachine) {
    const auto rows = automatic_choices();
    for (const AutomaticChoice& row : rows) EXPECT_NE(find_program(row.method), nullptr) << row.method;
    model::Parameters odd;
    odd.detail.friction = model::FrictionLaw::smoothed;
    odd.detail.stick_slip = true;
    EXPECT_TRUE(rows.back().suits(odd));
    for (const AutomaticChoice& row : rows) {
        if (!row.suits(odd)) continue;
        EXPECT_EQ(objection_to(row.method, odd), "") << row.method;
    }
}

TEST(AutomaticMethod, NamesThatAreGivenStay) {
    EXPECT_EQ(resolved_method("rk4", {}), "rk4");
    EXPECT_EQ(resolved_method("no such method", {}), "no such method") << "refused where methods are made";
}

/// Results are bitwise those of the method that it represents, and are known by that name.
TEST(AutomaticMethod, IsResolvedOnceWhenASimulationIsMade) {
    const engine::Cancellation unstopped;
    SilentObserver silent;
    Simulation automatic(claims::ready_scene("baseline", {"run.method=auto", "run.schedule=serial"}));
    Simulation named(claims::ready_scene("baseline", {"run.method=leapfrog-sweep", "run.schedule=serial"}));
    EXPECT_EQ(automatic.method().name(), "leapfrog-sweep");
    ASSERT_FALSE(automatic.advance({.until = 50e-6}, silent, unstopped));
    ASSERT_FALSE(named.advance({.until = 50e-6}, silent, unstopped));
    EXPECT_EQ(automatic.hash(), named.hash());
}

/// A simulation whose memory another scene takes over is of one method.
TEST(AutomaticMethod, DecidesWhetherAnotherSceneFits) {
    const Simulation simulation(claims::ready_scene("baseline", {"run.schedule=serial"}));
    EXPECT_TRUE(fits(simulation, claims::ready_scene("baseline", {"run.method=leapfrog-sweep"})));
    EXPECT_FALSE(fits(simulation, claims::ready_scene("baseline", {"detail.friction=smoothed"})));
}

}  // namespace
}  // namespace cvtflow::tasks
