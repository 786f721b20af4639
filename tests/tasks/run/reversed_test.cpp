/// Machines whose shafts turn backwards are mirror images.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tasks/channel/channels.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::tasks {
namespace {

/// Channels whose sign follows the sense of rotation.
[[nodiscard]] bool turns_sign(std::string_view name) {
    static const std::set<std::string_view> endings{"speed",   "pin_speed",     "angle", "torque", "chain_torque",
                                                    "impulse", "chain_impulse", "twist", "drag"};
    return name.starts_with("shaft_") && endings.contains(name.substr(8));
}

/// Leaves out a single pin, which a start places elsewhere, numbers of the method, and differences of nearly equal numbers.
[[nodiscard]] bool comparable(std::string_view name) {
    for (const char* group : {"followed_pin", "run/", "balance/", "control/", "tips/deepest", "misalignment"})
        if (name.starts_with(group)) return false;
    return !name.ends_with("sheave_position") && !name.ends_with("_deflection");
}

/// Parts of an energy or a power count relative to a fiftieth of the whole: dampers, and cylinders that hardly move, take noise.
[[nodiscard]] double min_scale(std::string_view name, const std::map<std::string_view, double>& means) {
    for (const auto& [group, whole] : {std::pair{"loss/", "loss/total"},
                                       {"dissipated/", "dissipated/total"},
                                       {"energy/", "energy/kinetic"},
                                       {"power/", "power/drive"},
                                       {"work/", "work/drive"}})
        if (name.starts_with(group)) return 0.02 * std::abs(means.at(whole));
    return 1e-6;
}

class Reversed : public testing::TestWithParam<const char*> {
protected:
    /// Means of every channel of one number over the outputs.
    static std::map<std::string_view, double> means(const std::string& sign, double until) {
        Simulation simulation(
            scene_of("baseline", GetParam(),
                     {"start.settling_time=40 ms", "drive.speed=" + sign + "2000 rpm", "load.torque=" + sign + "150",
                      "drag.driving_seals=0.5", "run.output_interval=20 us", "guide.stiffness=1e6", "guide.clearance=0"}));
        model::Observer observer(simulation.workspace().variator);
        std::map<std::string_view, double> sum;
        double outputs = 0.0;
        Outputs summed([&](double time, const Workspace& w, const Counters& counters) {
            const Instant now{w.observed_by(observer, time), w, counters, 0, observer};
            for (const Channel& channel : channels()) {
                if (channel.width(w.variator.chain()) != 1) continue;
                double value = 0.0;
                channel.read(now, &value);
                sum[channel.name] += value;
            }
            ++outputs;
        });
        settle_and_go(simulation, until, summed);
        for (auto& [name, value] : sum) value /= outputs;
        return sum;
    }
    static void expect_mirrored(double until, double tolerance) {
        const auto forward = means("", until), backward = means("-", until);
        for (const auto& [name, value] : forward) {
            const double image = backward.at(name);
            if (!comparable(name) || (std::isnan(value) && std::isnan(image))) continue;
            const double scale = std::max(std::abs(value), min_scale(name, forward));
            RecordProperty(std::string(name), std::to_string(std::abs(value - (turns_sign(name) ? -image : image)) / scale));
            EXPECT_NEAR(turns_sign(name) ? -image : image, value, tolerance * scale) << name;
        }
    }
};

/// Pins of the mirror image begin up to half a pitch elsewhere, and strands swing on from there, so that means over 46 pin periods differ:
/// most of them by less than 0.1 %, friction of the plates, which depends on that swing, by 0.5 %.
TEST_P(Reversed, HasTheMeansOfItsMirrorImage) { expect_mirrored(40e-3, 0.01); }
INSTANTIATE_TEST_SUITE_P(Rigid, Reversed, testing::Values("rigid"));
INSTANTIATE_TEST_SUITE_P(DeepHalves, Reversed, testing::Values("fine"));

/// The force would run into its limit within 100 ms with the feedback of the other sense of rotation.
TEST(ReversedControl, HoldsTheRatio) {
    for (const char* gains : {"given", "found"}) {
        Simulation simulation(
            scene_of("control", "rigid", {"drive.speed=-2000 rpm", "load.torque=-150", std::string("control.gains=") + gains}));
        settle_and_go(simulation, 0.1);
        model::Observer observer(simulation.workspace().variator);
        const model::Observation& now = simulation.workspace().observed_by(observer, simulation.time());
        EXPECT_NEAR(now.ratio, 1.0023, 0.0005) << gains;  // ripple of the pins
        EXPECT_FALSE(now.control_limited) << gains;
        EXPECT_GT(now.tight, now.slack + 1000.0) << "150 N·m over 54 mm pull 2.8 kN, in the lower strand";
    }
}

}  // namespace
}  // namespace cvtflow::tasks
