#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "tasks/run/simulation.hpp"
#include "tasks/tuning/output.hpp"
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

/// Gives outputs to two readers and keeps what the mean of a figure is made of.
struct TwoReaders final : RunObserver {
    OutputReader &all, &late;
    model::Observer eye;
    std::vector<double> time, slip, tight;
    double pin_period = 0.0;
    TwoReaders(OutputReader& a, OutputReader& b, const model::Variator& variator) : all(a), late(b), eye(variator) {}
    void output(double now, const Workspace& w, const Counters& c) override {
        all.output(now, w, c);
        late.output(now, w, c);
        const model::Observation& seen = eye.observe(now, w.state(), w.tips.phases.data());
        time.push_back(now);
        slip.push_back(seen.slip);
        tight.push_back(seen.tight);
        pin_period = w.pin_period();
    }
    void transition(const TransitionRecord&) override {}
    /// Over the last whole pin periods, values linear between outputs.
    [[nodiscard]] double mean(const std::vector<double>& value) const {
        const double lasted = std::floor((time.back() - time.front()) / pin_period) * pin_period, begin = time.back() - lasted;
        double sum = 0.0;
        for (std::size_t k = 1; k < time.size(); ++k) {
            const double share = std::clamp((time[k] - begin) / (time[k] - time[k - 1]), 0.0, 1.0);
            sum += share * (time[k] - time[k - 1]) * 0.5 * (value[k] + value[k - 1]);
        }
        return sum / lasted;
    }
};

TEST(OutputReader, CountsFromItsTimeOnAndFiguresAreOverWholePinPeriods) {
    const Scene scene = test::settled_tiny({"run.until=5 ms"});
    const auto outputs = tuned_outputs({"slip", "slip mean", "tight_tension", "tight_tension mean", "tips"}, true);
    Simulation simulation(scene);
    OutputReader all(simulation.workspace().variator, outputs, 0, 0.0);
    OutputReader late(simulation.workspace().variator, outputs, 0, 1.0);
    TwoReaders both(all, late, simulation.workspace().variator);
    const engine::Cancellation never;
    ASSERT_FALSE(simulation.advance({.until = scene.run.until}, both, never));
    ASSERT_GT(both.time.back(), both.pin_period);
    const std::vector<double> values = all.values();
    const auto over_time = [&](const std::vector<double>& value) {
        double sum = 0.0;
        for (std::size_t k = 1; k < value.size(); ++k) sum += 0.5 * (value[k] + value[k - 1]) * (both.time[k] - both.time[k - 1]);
        return sum / (both.time.back() - both.time.front());
    };
    EXPECT_NEAR(values[0], both.mean(both.slip), 1e-9);
    EXPECT_NEAR(values[1], over_time(both.slip), 1e-12);
    EXPECT_NEAR(values[2], both.mean(both.tight), 1e-9 * values[2]);
    EXPECT_NEAR(values[3], over_time(both.tight), 1e-9 * values[3]);
    EXPECT_GT(values[4], 0.0);
    EXPECT_TRUE(std::isnan(late.values()[1]));
}

}  // namespace

}  // namespace cvtflow::tasks
