#include "bench/method/analysis/plan_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

#include "bench/method/product_names.hpp"
#include "bench/method/stability/friction_stability.hpp"
#include "engine/method/catalogue.hpp"
#include "engine/method/compiled_plan.hpp"
#include "tests/engine/method/plan_fixture.hpp"

namespace cvtflow::bench {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Message of validate() about the two half Euler steps after one change.
std::string complaint(const std::function<void(StagePlan&)>& change) {
    StagePlan plan = engine::test::two_half_euler_steps();
    change(plan);
    try {
        validate(plan);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "";
}

/// Whether rows combine velocities that are kept, the slope of the stage before, and that of stage 0.
bool is_chained(const StagePlan& plan) {
    const CompiledPlan compiled(plan);
    bool chained = true;
    for (int row = 1; row <= compiled.stages(); ++row) {
        const PlanStep next = row < compiled.stages() ? compiled.stage(row) : compiled.result();
        chained = chained && (row == compiled.stages() || next.keep >= 0);
        for (const Term& term : next.slopes) chained = chained && (term.slot == 0 || term.slot == compiled.stage(row - 1).slope);
    }
    return chained;
}

TEST(PlanCheck, SoundPlansAreAccepted) {
    EXPECT_NO_THROW(validate(engine::test::two_half_euler_steps()));
    EXPECT_NO_THROW(validate(engine::test::dumka3_degree_3()));
    EXPECT_NO_THROW(validate(engine::test::dumka3_degree_6()));
}

TEST(PlanCheck, EveryTableOfTheCatalogueIsSound) {
    for (const StagePlan& plan : methods()) EXPECT_NO_THROW(validate(plan)) << plan.name;
}

TEST(PlanCheck, EveryTableOfFrictionIsSoundAndChained) {
    for (const Kick& kick : {chebyshev_kick, rkc_kick}) {
        for (int stages = 2; stages <= 400; ++stages) {
            const StagePlan plan = kick.plan(stages);
            EXPECT_NO_THROW(validate(plan)) << plan.name;
            EXPECT_TRUE(is_chained(plan)) << plan.name;
        }
    }
}

TEST(PlanCheck, ComplaintsNamePlanAndStage) {
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].slopes[0].slot = 7; }),
                AllOf(HasSubstr("two half Euler steps"), HasSubstr("stage 1")));
}

TEST(PlanCheck, EverySlotMustBeInRange) {
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

TEST(PlanCheck, StateFactorsSumToOneAndThoseOfTheErrorToZero) {
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].states[0].factor = 1.0 + 2e-12; }), HasSubstr("sum"));
    EXPECT_EQ(complaint([](StagePlan& plan) { plan.stages[1].states[0].factor = 1.0 + 5e-13; }), "");
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.result.states.clear(); }), AllOf(HasSubstr("result"), HasSubstr("sum")));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.error = Combination{{{0, 1.0}}, {}}; }), AllOf(HasSubstr("error"), HasSubstr("sum")));
    EXPECT_EQ(complaint([](StagePlan& plan) { plan.error = Combination{{{0, 1.0}, {1, -1.0}}, {{0, 0.5}}}; }), "");
}

TEST(PlanCheck, FactorsAreFinite) {
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].slopes[0].factor = std::nan(""); }), HasSubstr("finite"));
}

TEST(PlanCheck, NothingIsReadBeforeItIsWritten) {
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].states[0].slot = 1; }), HasSubstr("before it is written"));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].slopes[0].slot = 1; }), HasSubstr("before it is written"));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].keep = -1; }),
                AllOf(HasSubstr("result"), HasSubstr("before it is written")));
}

TEST(PlanCheck, NoStageWritesASlotThatItReads) {
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

TEST(PlanCheck, SlotsZeroHoldTheStartOfTheStepForTheWholeStep) {
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].slope = 0; }), HasSubstr("slope slot 0"));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[1].keep = 0; }), HasSubstr("state slot 0"));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages[0].slope = 1; }), AllOf(HasSubstr("stage 0"), HasSubstr("must be f(t, y)")));
    EXPECT_THAT(complaint([](StagePlan& plan) { plan.stages.clear(); }), HasSubstr("no stage"));
}

TEST(PlanCheck, ButcherTableauxMustBeExplicitAndComplete) {
    EXPECT_THROW((void)butcher_plan("wide", "", "", {{0.5, 0.5}}, {0.5, 0.5}), std::invalid_argument);
    EXPECT_THROW((void)butcher_plan("short", "", "", {{0.5}}, {1.0}), std::invalid_argument);
    EXPECT_THROW((void)butcher_plan("embedded", "", "", {{0.5}}, {0.0, 1.0}, {1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace cvtflow::bench
