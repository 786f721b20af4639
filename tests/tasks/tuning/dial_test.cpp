#include "tasks/tuning/dial.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/machine/coefficients.hpp"
#include "model/parameters/chain_layout.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

using model::ChainLayout;
using model::End;

const engine::Cancellation uncancelled;

DialSweep dial_of(const Scene& scene, const PointTimes& times, const std::vector<std::string>& outputs) {
    return {points_of(scene, times, tuned_outputs(outputs, true)), uncancelled};
}

/// Whether means of `baseline` with settings, at rigid, are unsteady.
bool unsteady(const std::vector<std::string>& settings) {
    Scene scene = read_scene(find_scene("baseline"));
    set_values(scene, settings);
    return dial_of(scene, {}, {"slip"}).run({"rigid", RunSettings{}.method}, 0.0, 0).unsteady;
}

/// A start state of another speed: 20 ms later the machine still accelerates, and errors are those of that.
TEST(DialSweep, FindsMeansThatStillChange) {
    EXPECT_FALSE(unsteady({}));
    EXPECT_TRUE(unsteady({"drive.speed=3000 rpm", "load.torque=90", "clamping.driving=25.5 kN"}));
}

/// The shortest window has no mean over a pin period.
TEST(DialSweep, ReferencesStateMeansThatStillChange) {
    DialSweep brief = dial_of(test::settled_tiny(), {1e-3, 0.2e-3}, {"tight_tension"});
    const DialSweep::Reference& reference = brief.reference(0, 0.5);
    ASSERT_NE(reference.run, nullptr);
    EXPECT_THAT(reference.text, testing::HasSubstr("unsteady: its means still change"));
}

/// A case of a tuned sweep is the run that was measured, bit for bit: one engine runs both.
TEST(DialSweep, RunsAChoiceAsASweepDoes) {
    DialSweep dial = dial_of(test::settled_tiny(), {0.5e-3, 0.5e-3}, {"tight_tension", "slack_tension"});
    EXPECT_EQ(dial.run({"rigid", RunSettings{}.method}, 2e-6, 0).values, dial.run({"rigid", RunSettings{}.method}, 2e-6, 0).values);
    EXPECT_NE(dial.run({"rigid", RunSettings{}.method}, 2e-6, 0).values, dial.run({"rigid", RunSettings{}.method}, 1e-6, 0).values);
}

/// The scene of a point.
Scene scene_at(const OperatingPoints& points, std::size_t point) {
    Scene scene = points.sweep.scene;
    points.sweep.apply_case(points.cases[point], scene);
    return scene;
}

std::vector<TunedOutput> usual() { return tuned_outputs({}, true); }

TEST(OperatingPoints, OfASceneWithConstantInputsAreItsStart) {
    const OperatingPoints points = points_of(ready_tiny(), {1e-3, 2e-3}, usual());
    EXPECT_THAT(points.names, testing::ElementsAre("start"));
    EXPECT_EQ(points.sweep.from, 1e-3);
    EXPECT_EQ(points.sweep.scene.run.until.value, 3e-3);
}

TEST(OperatingPoints, HoldEveryTableAtItsEndsAndTheOthersAsTheyBegin) {
    const Scene scene = scene_of("tiny", "", {"load.torque=[[0, 10], [1, 16], [2, 4]]", "clamping.driven=[[0, 5000], [1, 6000]]"});
    const OperatingPoints points = points_of(scene, {}, usual());
    EXPECT_THAT(points.names, testing::ElementsAre("start", "load.torque = 4 N*m", "load.torque = 16 N*m", "clamping.driven = 6000 N"));
    for (std::size_t i = 0; i < points.cases.size(); ++i) {
        const Scene at = scene_at(points, i);
        EXPECT_EQ(at.parameters.load.torque.value.size(), 1u) << points.names[i];
        EXPECT_EQ(at.parameters.load.torque.at(0.0) == 10.0, !points.names[i].starts_with("load")) << points.names[i];
    }
}

TEST(OperatingPoints, ThatAreUnseenLieBetweenThoseEnds) {
    const Scene scene = scene_of("tiny", "", {"load.torque=[[0, 10], [1, 16], [2, 4]]"});
    const OperatingPoints points = unseen_points(scene, {}, usual(), 20, 7);
    double low = 1e9, high = 0.0;
    for (std::size_t i = 0; i < 20; ++i) {
        const model::Parameters at = scene_at(points, i).parameters;
        const double torque = at.load.torque.at(0.0), driving = at.clamping.driving.at(0.0);
        EXPECT_TRUE(torque > 4.0 && torque < 16.0) << points.names[i];
        EXPECT_NEAR(driving, 7700.0, 0.05 * 7700.0);
        EXPECT_NE(driving, 7700.0);
        low = std::min(low, torque), high = std::max(high, torque);
    }
    EXPECT_GT(high - low, 6.0) << "twenty of twelve N m";
    EXPECT_EQ(points.names, unseen_points(scene, {}, usual(), 20, 7).names);
    EXPECT_NE(points.names, unseen_points(scene, {}, usual(), 20, 8).names);
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
    for (const TunedOutput& output : tuned_outputs({}, true)) all.push_back(output.name);
    for (const TunedOutput& output : tuned_outputs({}, false)) ring.push_back(output.name);
    EXPECT_THAT(all, testing::ElementsAre("slip", "efficiency", "tight_tension", "tips"));
    EXPECT_THAT(ring, testing::ElementsAre("tight_tension")) << "a chain without pulleys has neither slip nor tips that touch";
}

TEST(TunedOutputs, TakeScalarsAsSweepsWriteThemAndRefuseWhatIsNeither) {
    EXPECT_EQ(tuned_outputs({"slip   median"}, true).front().name, "slip median");
    EXPECT_THAT(message_of([] { return tuned_outputs({"slipp"}, true); }),
                testing::AllOf(testing::HasSubstr("outputs: slipp is not one of slip, efficiency"), testing::HasSubstr("did you mean")));
    EXPECT_THROW(static_cast<void>(tuned_outputs({"slip"}, false)), SceneError);
}

TEST(TunedOutputs, ErrorsAreRelativeAndThoseOfEfficiencyPercentagePoints) {
    const auto outputs = tuned_outputs({"slip", "efficiency", "tight_tension", "losses"}, true);
    EXPECT_DOUBLE_EQ(outputs[0].error(0.003, 0.004), 0.25);
    EXPECT_DOUBLE_EQ(outputs[0].error(0.0, 1e-5), 0.1) << "creep below 1e-4 is compared with that";
    EXPECT_DOUBLE_EQ(outputs[1].error(0.97, 0.98), 0.98 - 0.97);
    EXPECT_DOUBLE_EQ(outputs[2].error(110.0, 100.0), 0.1);
    EXPECT_DOUBLE_EQ(outputs[3].error(0.97, 0.98), (0.98 - 0.97) / (1.0 - 0.98)) << "of the losses";
    EXPECT_EQ(outputs[0].error(std::nan(""), 1.0), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace cvtflow::tasks
