#include "bench/study/error_measure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tasks/run/run.hpp"
#include "tests/temporary_file_fixture.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

using Numbers = std::vector<double>;

Trajectory two_outputs(double tension) {
    Trajectory trajectory;
    trajectory.times = {1.0, 2.0};
    trajectory.axial_force = {{3.0, 4.0}, {3.0, 4.0}};
    trajectory.tension = {{tension}, {2.0}};
    trajectory.slip = {0.01, 0.01};
    trajectory.losses = {0.0, 5.0};
    return trajectory;
}

/// Differences are (1, 0) of (1, 2): 1/sqrt(5) over all, 1 at the first output.
TEST(ErrorMeasureCompare, ErrorsAreRelativeOverAllOutputsAndAtTheWorst) {
    const ErrorReport report = compare(two_outputs(2.0), two_outputs(1.0));
    EXPECT_DOUBLE_EQ(report.overall.tension, 1.0 / std::sqrt(5.0));
    EXPECT_DOUBLE_EQ(report.worst.tension, 1.0);
    EXPECT_EQ(report.overall.axial_force, 0.0);
    EXPECT_EQ(report.overall.losses, 0.0);
    EXPECT_EQ(report.overall.largest(), report.overall.tension);
}

TEST(ErrorMeasureCompare, ARunThatEndedEarlyOrIsNotANumberIsInfinitelyWrong) {
    Trajectory lost = two_outputs(1.0);
    lost.fault.kind = FaultKind::non_finite;
    EXPECT_TRUE(std::isinf(compare(lost, two_outputs(1.0)).overall.tension));
    EXPECT_TRUE(std::isinf(compare(two_outputs(std::nan("")), two_outputs(1.0)).overall.largest()));
    EXPECT_THROW((void)compare(two_outputs(1.0), lost), std::invalid_argument);
}

TEST(ErrorMeasureCompare, OtherOutputTimesAreRefused) {
    Trajectory shifted = two_outputs(1.0);
    shifted.times[1] = 3.0;
    EXPECT_THROW((void)compare(shifted, two_outputs(1.0)), std::invalid_argument);
}

/// The smallest scene after a millisecond of settling, with its state on file.
class ErrorMeasureRuns : public testing::Test {
protected:
    [[nodiscard]] Scene settled() const {
        Scene scene = read_scene(CVTFLOW_SOURCE_DIR "/scenes/tiny.toml");
        const std::string& file = state_.path();
        set_values(scene, std::vector<std::string>{"start.settling_time=1ms", "start.ramp_time=0.5ms", "run.schedule=serial"});
        settle_scene(scene, file, {});
        set_value(scene, "start.state=" + file);
        return scene;
    }
    static MeasureSettings brief() {
        MeasureSettings settings;
        settings.duration = 24e-6;
        return settings;
    }

private:
    const cvtflow::tests::TemporaryFile state_{"error_measure"};
};

TEST_F(ErrorMeasureRuns, TheReferenceAgreesWithItselfAndALongerStepDoesNot) {
    const engine::Cancellation never;
    const ErrorMeasure measure(settled(), brief(), never);
    const Trajectory same = measure.run(brief().reference);
    EXPECT_EQ(same.hash, measure.reference().hash);
    EXPECT_EQ(measure.errors(same).worst.largest(), 0.0);
    EXPECT_EQ(same.times.size(), 2u);
    const Trajectory fine = measure.run(std::vector<std::string>{"run.step=25ns"}),
                     coarse = measure.run(std::vector<std::string>{"run.step=50ns"});
    EXPECT_LT(measure.errors(fine).overall.axial_force, measure.errors(coarse).overall.axial_force);
    EXPECT_GT(measure.errors(fine).overall.axial_force, 0.0);
    EXPECT_NEAR(coarse.evaluations_per_second(), 8e7, 0.1e7);
    EXPECT_GT(coarse.wall_per_second(), 0.0);
    EXPECT_DOUBLE_EQ(coarse.step, 5e-8);
}

TEST_F(ErrorMeasureRuns, AnUnsettledStartIsRefused) {
    const engine::Cancellation never;
    const Scene tiny = read_scene(CVTFLOW_SOURCE_DIR "/scenes/tiny.toml");
    EXPECT_THROW(ErrorMeasure(tiny, brief(), never), SimulationError);
}

TEST_F(ErrorMeasureRuns, ShorterStepsOfAStabilisedMethodAreCloserAndCostMore) {
    const engine::Cancellation never;
    MeasureSettings settings = brief();
    settings.duration = 60e-6;
    settings.reference = {"run.method=rk4", "run.step=25ns"};
    const ErrorMeasure measure(settled(), settings, never);
    const Trajectory longer = measure.run(std::vector<std::string>{"run.method=dumka3-p2", "run.step=2us"}),
                     shorter = measure.run(std::vector<std::string>{"run.method=dumka3-p2", "run.step=1us"});
    EXPECT_LT(measure.errors(shorter).overall.tension, measure.errors(longer).overall.tension);
    EXPECT_GT(shorter.counters.evaluations, longer.counters.evaluations);
    double short_errors = 0.0, long_errors = 0.0;
    for (int pin = 0; pin < 24; ++pin) {
        short_errors += pin_error(shorter, measure.reference(), pin);
        long_errors += pin_error(longer, measure.reference(), pin);
        EXPECT_EQ(pin_error(measure.reference(), measure.reference(), pin), 0.0);
    }
    EXPECT_LT(short_errors, long_errors);
}

TEST(Trajectory, APinsForceIsThatOfItsTwoHalves) {
    Trajectory run;
    run.side = {0.0, 0.0, 0.0};
    run.axial_force = {{1, 2, 3, 4, 10, 20, 30, 40, 100, 200, 300, 400}};  // 4 per link: rear -z, rear +z, front -z, front +z
    EXPECT_EQ(run.pin_axial(1, 0), std::vector<double>{10 + 3});
    EXPECT_EQ(run.pin_axial(1, 1), std::vector<double>{20 + 4});
    EXPECT_EQ(run.pin_axial(0, 0), std::vector<double>{1 + 300});
}

TEST(Trajectory, APinEntersWhereATipOfTheDrivingSideComesToTouch) {
    model::Parameters parameters;
    parameters.chain.pins = 3;
    Trajectory run;
    run.side = {0.9 * parameters.pulley.centre_distance, 0.0, 0.0};
    EXPECT_FALSE(first_entry(run, parameters));
    const auto record = [&](double time, int pin, model::Phase from, model::Phase to) {
        TransitionRecord transition{};
        transition.time = time;
        transition.pin = pin;
        transition.from = from;
        transition.to = to;
        run.transitions.push_back(transition);
    };
    record(1e-6, 0, model::Phase::free, model::Phase::touching);  // enters the driven pulley
    record(2e-6, 1, model::Phase::touching, model::Phase::free);  // leaves
    record(3e-6, 2, model::Phase::free, model::Phase::touching);
    ASSERT_TRUE(first_entry(run, parameters));
    EXPECT_EQ(first_entry(run, parameters)->pin, 2);
    EXPECT_EQ(first_entry(run, parameters)->time, 3e-6);
}

TEST(RelativeError, IsTheDistanceOverTheLengthOfTheReference) {
    EXPECT_DOUBLE_EQ(relative_error(Numbers{3.0, 4.5}, Numbers{3.0, 4.0}), 0.1);
    RelativeError error;
    error.add(Numbers{3.0}, Numbers{3.0});
    RelativeError rest;
    rest.add(Numbers{4.5}, Numbers{4.0});
    error.add(rest);
    EXPECT_DOUBLE_EQ(error.value(), 0.1);
}

TEST(RelativeError, IsInfiniteForAZeroReferenceAndNumbersThatAreNotFinite) {
    EXPECT_EQ(relative_error(Numbers{0.0, 0.0}, Numbers{0.0, 0.0}), 0.0);
    EXPECT_EQ(relative_error(Numbers{1.0}, Numbers{0.0}), INFINITY);
    EXPECT_EQ(relative_error(Numbers{NAN}, Numbers{1.0}), INFINITY);
    EXPECT_EQ(relative_error(Numbers{1.0}, Numbers{NAN}), INFINITY);
}

}  // namespace
}  // namespace cvtflow::bench
