#include "engine/method/stage_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

#include "plan_fixture.hpp"

namespace cvtflow::engine {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Message of validate() about the two half Euler steps after one change.
std::string complaint(const std::function<void(StagePlan&)>& change) {
    StagePlan plan = test::two_half_euler_steps();
    change(plan);
    try {
        validate(plan);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "";
}

TEST(StagePlan, SoundPlansAreAccepted) {
    EXPECT_NO_THROW(validate(test::two_half_euler_steps()));
    EXPECT_NO_THROW(validate(test::dumka3_degree_3()));
    EXPECT_NO_THROW(validate(test::dumka3_degree_6()));
}

TEST(StagePlan, ComplaintsNamePlanAndStage) {
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].slopes[0].slot = 7; }),
                AllOf(HasSubstr("two half Euler steps"), HasSubstr("stage 1")));
}

TEST(StagePlan, EverySlotMustBeInRange) {
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].slopes[0].slot = 2; }), HasSubstr("outside"));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].states[0].slot = -1; }), HasSubstr("outside"));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].keep = 2; }), HasSubstr("outside"));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].keep = -2; }), HasSubstr("outside"));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].slope = -1; }), HasSubstr("outside"));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.result.states[0].slot = 2; }), AllOf(HasSubstr("result"), HasSubstr("outside")));
    EXPECT_THAT(complaint([](StagePlan& plan) {
                    plan.error = Combination{{}, {{9, 1.0}}};
                }),
                AllOf(HasSubstr("error estimate"), HasSubstr("outside")));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.state_slots = 0; }), HasSubstr("at least one"));
}

TEST(StagePlan, StateFactorsSumToOneAndThoseOfTheErrorToZero) {
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].states[0].factor = 1.0 + 2e-12; }), HasSubstr("sum"));
    EXPECT_EQ(complaint([](StagePlan& plan) { plan.stages[1].states[0].factor = 1.0 + 5e-13; }), "");
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.result.states.clear(); }), AllOf(HasSubstr("result"), HasSubstr("sum")));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.error = Combination{{{0, 1.0}}, {}}; }), AllOf(HasSubstr("error"), HasSubstr("sum")));
    EXPECT_EQ(complaint([](StagePlan& plan) { plan.error = Combination{{{0, 1.0}, {1, -1.0}}, {{0, 0.5}}}; }), "");
}

TEST(StagePlan, FactorsAreFinite) {
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].slopes[0].factor = std::nan(""); }), HasSubstr("finite"));
}

TEST(StagePlan, NothingIsReadBeforeItIsWritten) {
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].states[0].slot = 1; }), HasSubstr("before it is written"));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].slopes[0].slot = 1; }), HasSubstr("before it is written"));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].keep = -1; }),
                AllOf(HasSubstr("result"), HasSubstr("before it is written")));
}

TEST(StagePlan, NoStageWritesASlotThatItReads) {
    const Stage in_place_state{{{1, 1.0}}, {{1, 0.1}}, 1, 2};
    const Stage in_place_slope{{{1, 1.0}}, {{1, 0.1}}, 2, 1};
    const auto append = [](const Stage& stage) {
        return [stage](StagePlan& plan) {
            plan.state_slots = plan.slope_slots = 3;
            plan.stages.push_back(stage);
        };
    };
    EXPECT_THAT(complaint(append(in_place_state)), AllOf(HasSubstr("stage 2"), HasSubstr("state slot 1 and reads it")));
    EXPECT_THAT(complaint(append(in_place_slope)), AllOf(HasSubstr("stage 2"), HasSubstr("slope slot 1 and reads it")));
    EXPECT_EQ(complaint(append({{{1, 1.0}}, {{1, 0.1}}, 2, 2})), "");
}

TEST(StagePlan, SlotsZeroHoldTheStartOfTheStepForTheWholeStep) {
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].slope = 0; }), HasSubstr("slope slot 0"));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].keep = 0; }), HasSubstr("state slot 0"));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[0].slope = 1; }), AllOf(HasSubstr("stage 0"), HasSubstr("must be f(t, y)")));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages.clear(); }), HasSubstr("no stage"));
}

TEST(StagePlan, ButcherTableauxMustBeExplicitAndComplete) {
    EXPECT_THROW((void)butcher_plan("wide", "", "", {{0.5, 0.5}}, {0.5, 0.5}), std::invalid_argument);
    EXPECT_THROW((void)butcher_plan("short", "", "", {{0.5}}, {1.0}), std::invalid_argument);
    EXPECT_THROW((void)butcher_plan("embedded", "", "", {{0.5}}, {0.0, 1.0}, {1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace cvtflow::engine
