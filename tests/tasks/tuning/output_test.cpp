#include "tasks/tuning/output.hpp"

#include <gmock/gmock.h>

#include "tasks/run/simulation.hpp"
#include "tests/tasks/settled_tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

TEST(TunedOutputs, WithoutNamesAreTheUsualFiguresThatTheMachineHas) {
    std::vector<std::string> all, ring;
    for (const TunedOutput& output : tuned_outputs(std::vector<std::string>{}, true)) all.push_back(output.name);
    for (const TunedOutput& output : tuned_outputs(std::vector<std::string>{}, false)) ring.push_back(output.name);
    EXPECT_THAT(all, testing::ElementsAre("slip", "efficiency", "tight_tension", "tips"));
    EXPECT_THAT(ring, testing::ElementsAre("tight_tension")) << "a chain without pulleys has neither slip nor tips that touch";
}

TEST(TunedOutputs, TakeScalarsAsSweepsWriteThemAndRefuseWhatIsNeither) {
    EXPECT_EQ(tuned_outputs({"slip   median"}, true).front().name, "slip median");
    try {
        static_cast<void>(tuned_outputs({"slipp"}, true));
        FAIL();
    } catch (const SceneError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("outputs: slipp is not one of slip, efficiency"));
        EXPECT_THAT(error.what(), testing::HasSubstr("did you mean"));
    }
    EXPECT_THROW(static_cast<void>(tuned_outputs({"slip"}, false)), SceneError);
}

TEST(TunedOutputs, ErrorsAreRelativeAndThoseOfEfficiencyPercentagePoints) {
    const auto outputs = tuned_outputs({"slip", "efficiency", "tight_tension"}, true);
    EXPECT_DOUBLE_EQ(outputs[0].error(0.003, 0.004), 0.25);
    EXPECT_DOUBLE_EQ(outputs[0].error(0.0, 1e-5), 0.1) << "creep below 1e-4 is compared with that";
    EXPECT_DOUBLE_EQ(outputs[1].error(0.97, 0.98), 0.98 - 0.97);
    EXPECT_DOUBLE_EQ(outputs[2].error(110.0, 100.0), 0.1);
    EXPECT_EQ(outputs[0].error(std::nan(""), 1.0), std::numeric_limits<double>::infinity());
}

TEST(OutputReader, CountsFromItsTimeOn) {
    const Scene scene = test::settled_tiny();
    const auto outputs = tuned_outputs({"slip", "slip mean", "tight_tension", "tight_tension mean", "tips"}, true);
    Simulation simulation(scene);
    OutputReader all(simulation.variator(), outputs, 0, 0.0);
    OutputReader late(simulation.variator(), outputs, 0, 1.0);
    struct Both final : RunObserver {
        OutputReader &all, &late;
        Both(OutputReader& a, OutputReader& b) : all(a), late(b) {}
        void output(double time, const Workspace& w, const Counters& c) override {
            all.output(time, w, c);
            late.output(time, w, c);
        }
        void transition(const TransitionRecord&) override {}
    } both(all, late);
    const engine::Cancellation never;
    ASSERT_FALSE(simulation.advance({.until = scene.run.until}, both, never));
    const std::vector<double> values = all.values();
    EXPECT_NEAR(values[0], values[1], 1e-12) << "a figure and the scalar of the same meaning";
    EXPECT_NEAR(values[2], values[3], 1e-9 * values[2]);
    EXPECT_GT(values[4], 0.0);
    EXPECT_TRUE(std::isnan(late.values()[1]));
}

}  // namespace
}  // namespace cvtflow::tasks
