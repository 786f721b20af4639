#include "tasks/tuning/point_measure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/machine/coefficients.hpp"
#include "model/parameters/chain_layout.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tasks/tuning/output.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

using model::ChainLayout;
using model::End;

const engine::Cancellation uncancelled;

/// Whether means of `baseline` with settings, at rigid, are unsteady.
bool unsteady(const std::vector<std::string>& settings) {
    Scene scene = read_scene(find_scene("baseline"));
    set_values(scene, settings);
    const auto outputs = tuned_outputs({"slip"}, true);
    PointMeasure measure(points_of(scene, {}).front(), "rigid", outputs, uncancelled);
    return measure.run({"rigid", RunSettings{}.method, 1.0}).unsteady;
}

/// A start state of another speed: 20 ms later the machine still accelerates, and errors are those of that.
TEST(PointMeasure, FindsMeansThatStillChange) {
    EXPECT_FALSE(unsteady({}));
    EXPECT_TRUE(unsteady({"drive.speed=3000 rpm", "load.torque=90", "clamping.driving=25.5 kN"}));
}

/// The shortest window has no mean over a pin period.
TEST(PointMeasure, ReferencesStateMeansThatStillChange) {
    const Scene scene = read_scene(find_scene("baseline"));
    const auto outputs = tuned_outputs({"tight_tension"}, true);
    PointMeasure brief(points_of(scene, {1e-3, 0.2e-3}).front(), "rigid", outputs, uncancelled);
    ASSERT_NE(brief.reference(0.5), nullptr);
    EXPECT_THAT(brief.reference_text(), testing::HasSubstr("unsteady: its means still change"));
}

std::vector<std::string> names(const std::vector<OperatingPoint>& points) {
    std::vector<std::string> found;
    for (const OperatingPoint& point : points) found.push_back(point.name);
    return found;
}

Scene with(const std::vector<std::string>& settings) {
    Scene scene = ready_tiny();
    set_values(scene, settings);
    return scene;
}

TEST(OperatingPoints, OfASceneWithConstantInputsAreItsStart) {
    const auto points = points_of(ready_tiny(), {1e-3, 2e-3});
    EXPECT_THAT(names(points), testing::ElementsAre("start"));
    EXPECT_EQ(points[0].from, 1e-3);
    EXPECT_EQ(points[0].until, 3e-3);
    EXPECT_EQ(points[0].scene.run.until.value, 3e-3);
}

/// Points settle as a run does: else levels are compared from one settled state, and the run of the cheaper one settles to another.
TEST(OperatingPoints, OfASceneWithoutAStateThatFitsSettleByThemselves) {
    Scene scene = test::settled_tiny();
    EXPECT_FALSE(points_of(scene, {}).front().settles);
    scene.state_file.clear();
    EXPECT_TRUE(points_of(scene, {}).front().settles);
    EXPECT_TRUE(unseen_points(scene, {}, 1, 1).front().settles);
}

TEST(OperatingPoints, HoldEveryTableAtItsEndsAndTheOthersAsTheyBegin) {
    const Scene scene = with({"load.torque=[[0, 10], [1, 16], [2, 4]]", "clamping.driven=[[0, 5000], [1, 6000]]"});
    const auto points = points_of(scene, {});
    EXPECT_THAT(names(points),
                testing::UnorderedElementsAre("start", "load.torque = 4 N*m", "load.torque = 16 N*m", "clamping.driven = 6000 N"));
    for (const OperatingPoint& point : points) {
        EXPECT_EQ(point.scene.parameters.load.torque.value.size(), 1u) << point.name;
        const bool own = point.name.starts_with("load");
        EXPECT_EQ(point.scene.parameters.load.torque.at(0.0) == 10.0, !own) << point.name;
    }
}

TEST(OperatingPoints, ThatAreUnseenLieBetweenThoseEnds) {
    const Scene scene = with({"load.torque=[[0, 10], [1, 16], [2, 4]]"});
    const auto points = unseen_points(scene, {}, 20, 7);
    double low = 1e9, high = 0.0;
    for (const OperatingPoint& point : points) {
        const double torque = point.scene.parameters.load.torque.at(0.0), driving = point.scene.parameters.clamping.driving.at(0.0);
        EXPECT_TRUE(torque > 4.0 && torque < 16.0) << point.name;
        EXPECT_NEAR(driving, 7700.0, 0.05 * 7700.0);
        EXPECT_NE(driving, 7700.0);
        low = std::min(low, torque), high = std::max(high, torque);
    }
    EXPECT_GT(high - low, 6.0) << "twenty of twelve N m";
    EXPECT_EQ(names(points), names(unseen_points(scene, {}, 20, 7)));
    EXPECT_NE(names(points), names(unseen_points(scene, {}, 20, 8)));
}

Sweep sweep_over(std::vector<Axis> axes) {
    Sweep sweep;
    sweep.scene = ready_tiny();
    sweep.axes = std::move(axes);
    return sweep;
}

TEST(CornerCases, CombineTheRowsInWhichAKeyIsLowestOrHighest) {
    const Axis torque{"list", {find_parameter("load.torque")}, {8.0, 14.0, 6.0, 10.0}};
    const Axis speed{"list", {find_parameter("drive.speed")}, {100.0, 150.0, 200.0}};
    // rows 0, 1, 2 and 3 of the torques: first, highest, lowest, last; rows 0 and 2 of the speeds
    EXPECT_THAT(corner_cases(sweep_over({torque, speed})), testing::ElementsAre(0, 2, 3, 5, 6, 8, 9, 11));
    EXPECT_THAT(corner_cases(sweep_over({torque, speed}), 3), testing::ElementsAre(0, 5, 11));
}

TEST(CornerCases, LeaveOutWhatContradictsItself) {
    const Axis inner{"list", {find_parameter("pulley.innermost")}, {10e-3, 11e-3, 30e-3}};
    const auto corners = corner_cases(sweep_over({inner}));
    EXPECT_THAT(corners, testing::ElementsAre(0)) << "30 mm are beyond pulley.outermost";
}

constexpr unsigned char phase(model::Phase of) { return static_cast<unsigned char>(of); }
constexpr unsigned char untouched = phase(model::Phase::free), touching = phase(model::Phase::touching);

/// Parameters of `tiny` with other detail.
model::Parameters tiny_with(model::PinDetail pins) {
    model::Parameters parameters = tiny_parameters();
    parameters.detail.pins = pins;
    return parameters;
}

/// Pins on a circle of 30 mm, and different numbers in all other coordinates and velocities.
engine::SavedState ring(const model::Parameters& parameters) {
    const ChainLayout at = model::layout_of(parameters);
    engine::SavedState saved;
    saved.state.resize(static_cast<std::size_t>(at.control_begin()));
    for (std::size_t k = 0; k < saved.state.size(); ++k) saved.state[k] = 1e-4 * std::sin(static_cast<double>(k));
    const auto put = [&](int link, End end, double angle) {
        double* q = saved.state.data() + at.link_begin(link);
        q[at.x(end, 0)] = 0.03 * std::cos(angle);
        q[at.y(end, 0)] = 0.03 * std::sin(angle);
    };
    for (int link = 0; link < at.links; ++link) {
        const double pitch = 2.0 * M_PI / at.links;
        put(link, End::rear, -pitch * link);
        if (!at.rigid) put(link, End::front, -pitch * (link + 0.9));
    }
    saved.phases.assign(static_cast<std::size_t>(model::tips_per_link * at.links), untouched);
    return saved;
}

TEST(DetailState, PutsARigidPinInTheMiddleBetweenItsHalves) {
    const model::Parameters halves = tiny_with(model::PinDetail::halves), rigid = tiny_with(model::PinDetail::rigid);
    const ChainLayout from = model::layout_of(halves), to = model::layout_of(rigid);
    engine::SavedState saved = ring(halves);
    saved.phases[7] = touching;
    const engine::SavedState over = convert_state(saved, halves, rigid);
    ASSERT_EQ(over.state.size(), static_cast<std::size_t>(to.control_begin()));
    EXPECT_EQ(over.phases, saved.phases) << "four tips, as before";
    const double plate_bow = model::Coefficients(rigid).plate_bow;
    for (int pin = 0; pin < to.links; ++pin) {
        const double* rear = saved.state.data() + from.link_begin(pin);
        const double* front = saved.state.data() + from.link_begin(from.previous(pin));
        const double* q = over.state.data() + to.link_begin(pin);
        const auto mean = [&](int m) { return 0.5 * (rear[from.x(End::rear, m)] + front[from.x(End::front, m)]); };
        EXPECT_DOUBLE_EQ(q[to.x(End::rear, 0)], mean(0) + plate_bow * mean(2)) << pin;
        EXPECT_DOUBLE_EQ(q[to.x(End::rear, 2)], mean(2)) << pin;
        const double* v = q + to.link_size();
        const double before = front[from.link_size() + from.z(End::front)], behind = rear[from.link_size() + from.z(End::rear)];
        EXPECT_DOUBLE_EQ(v[to.z(End::rear)], 0.5 * (behind + before)) << pin;
        EXPECT_DOUBLE_EQ(v[to.e(End::rear)], before - behind) << pin;
    }
}

/// A rigid pin refers to the middle of its plates, and its halves slide on each other: their mean and difference along z.
TEST(DetailState, OfRigidPinsComesBackFromHalves) {
    const model::Parameters halves = tiny_with(model::PinDetail::halves), rigid = tiny_with(model::PinDetail::rigid);
    const ChainLayout from = model::layout_of(rigid), to = model::layout_of(halves);
    const engine::SavedState saved = ring(rigid), over = convert_state(saved, rigid, halves), back = convert_state(over, halves, rigid);
    ASSERT_EQ(back.state.size(), saved.state.size());
    for (std::size_t k = 0; k < saved.state.size(); ++k) EXPECT_NEAR(back.state[k], saved.state[k], 1e-17 + 1e-14 * 0.03) << k;
    for (int pin = 0; pin < from.links; ++pin) {
        const double* rear = over.state.data() + to.link_begin(pin);
        const double* front = over.state.data() + to.link_begin(to.previous(pin));
        const double* q = saved.state.data() + from.link_begin(pin);
        EXPECT_NEAR(front[to.z(End::front)] - rear[to.z(End::rear)], q[from.e(End::rear)], 1e-18) << pin;
        EXPECT_EQ(rear[to.x(End::rear, 2)], q[from.x(End::rear, 2)]) << pin;
        const double x = 0.5 * (rear[to.x(End::rear, 0)] + front[to.x(End::front, 0)]);
        EXPECT_NEAR(x, q[from.x(End::rear, 0)] - model::Coefficients(rigid).plate_bow * q[from.x(End::rear, 2)], 1e-17) << pin;
    }
}

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
