#include "tasks/method/method_choice.hpp"

#include <gtest/gtest.h>

#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {
namespace {

TEST(MethodChoice, WhatProgramsSayOfTheirErrorIsWhatTheyDo) {
    const Scene scene = read_scene(CVTFLOW_SOURCE_DIR "/scenes/tiny.toml");
    int estimating = 0;
    for (const MethodProgram& program : method_programs()) {
        Workspace workspace(scene.parameters, *plan_for(program.name), Partition::equal(scene.parameters.chain.pins, 1));
        EXPECT_EQ(may_estimate_error(program.name), make_step_method(program.name, workspace)->error_power() != 0) << program.name;
        estimating += program.estimates_error;
    }
    EXPECT_GE(estimating, 4);  // those that follow the spectrum, at least
}

TEST(MethodChoice, TablesEstimateTheirErrorIfTheyHoldAnEstimate) {
    EXPECT_TRUE(may_estimate_error("dopri54"));
    EXPECT_FALSE(may_estimate_error("rk4"));
    EXPECT_TRUE(may_estimate_error("rkc-s37-e10"));
}

}  // namespace
}  // namespace cvtflow::tasks
