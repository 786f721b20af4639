#include "tasks/method/method.hpp"

#include <gtest/gtest.h>

#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {
namespace {

TEST(MethodChoice, WhatProgramsSayOfTheirErrorIsWhatTheyDo) {
    const Scene halves = read_scene(CVTFLOW_SOURCE_DIR "/scenes/tiny.toml");
    Scene rigid = halves;
    apply_detail(rigid, "rigid");
    int estimating = 0;
    for (const MethodProgram& program : method_programs()) {
        const Scene& scene = program.objection(halves.parameters).empty() ? halves : rigid;
        Workspace workspace(scene.parameters, Method(program.name).plan(), Partition::equal(scene.parameters.chain.pins, 1));
        EXPECT_EQ(Method(program.name).estimates_error(), Method(program.name).make(workspace)->error_power() != 0) << program.name;
        estimating += program.estimates_error;
    }
    EXPECT_GE(estimating, 4);  // those that follow the spectrum, at least
}

TEST(MethodChoice, TablesEstimateTheirErrorIfTheyHoldAnEstimate) {
    EXPECT_TRUE(Method("dopri54").estimates_error());
    EXPECT_FALSE(Method("rk4").estimates_error());
    EXPECT_TRUE(Method("rkc-s37-e10").estimates_error());
}

}  // namespace
}  // namespace cvtflow::tasks
