#include "tasks/channel/channels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <string>

#include "tasks/run/simulation.hpp"
#include "tests/claims/rig_fixture.hpp"
#include "tests/tasks/settled_tiny_fixture.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

/// Reads a channel into memory with a guard behind its width.
std::vector<double> read(const Channel& channel, const Instant& now) {
    constexpr double guard = 1.23456789e300;
    const std::size_t width = static_cast<std::size_t>(channel.width(now.workspace.variator.chain()));
    std::vector<double> values(width + 1, std::nan(""));
    values.back() = guard;
    channel.read(now, values.data());
    EXPECT_EQ(values.back(), guard) << channel.name << " writes beyond its width";
    values.pop_back();
    return values;
}

void expect_finite(claims::Rig& rig, bool pulleys) {
    model::Observer observer(rig.variator());
    const model::Observation& observation = observer.observe(rig.time(), rig.state(), rig.phases().data());
    const int last_pin = rig.variator().layout().links - 1;
    for (const int pin : {0, last_pin}) {
        const Instant now{observation, rig.workspace(), rig.counters(), pin, observer};
        for (const Channel& channel : channels()) {
            if (!channel.is(Channel::any_machine) && !pulleys) continue;
            const std::vector<double> values = read(channel, now);
            EXPECT_FALSE(values.empty()) << channel.name;
            const bool defined = channel.name != "efficiency_with_pump";  // without a pump, and without an output before
            for (const double value : values) EXPECT_EQ(std::isfinite(value), defined) << channel.name;
        }
    }
}

TEST(Channels, AllAreFiniteAndOfTheirWidthOnAVariator) {
    claims::Rig rig(tiny_parameters());
    ASSERT_FALSE(rig.run({-10e-3, -9e-3, 5e-8, 1e-4}));
    expect_finite(rig, true);
}

TEST(Channels, AllAreFiniteAndOfTheirWidthOnAFreeRing) {
    model::Parameters p = tiny_parameters();
    p.detail.pulleys = model::PulleyDetail::absent;
    p.start.layout = model::StartLayout::ring;
    claims::Rig rig(p);
    ASSERT_FALSE(rig.run({0.0, 1e-5, 5e-8, 1e-5}));
    expect_finite(rig, false);
}

/// From an observer that has never seen the chain: whatever is of the chain would be zero.
TEST(Channels, WithoutTheChainReadTheSameOfShaftsAlone) {
    claims::Rig rig(tiny_parameters());
    ASSERT_FALSE(rig.run({-10e-3, -9e-3, 5e-8, 1e-4}));
    model::Observer observer(rig.variator()), of_shafts(rig.variator());
    const Instant whole{rig.workspace().observed_by(observer, rig.time()), rig.workspace(), rig.counters(), 0, observer};
    const Instant shafts{rig.workspace().shafts_observed_by(of_shafts, rig.time()), rig.workspace(), rig.counters(), 0, of_shafts};
    int count = 0;
    for (const Channel& channel : channels()) {
        EXPECT_TRUE(channel.needs_chain(Counters{})) << channel.name << ": at the first instant";
        if (channel.needs_chain(rig.counters())) continue;
        ++count;
        const std::vector<double> values = read(channel, shafts), expected = read(channel, whole);
        for (std::size_t k = 0; k < values.size(); ++k) EXPECT_TRUE(values[k] == expected[k] || std::isnan(expected[k])) << channel.name;
    }
    EXPECT_GT(count, 70);
    EXPECT_FALSE(read(channels()[0], shafts)[0] == 0.0) << "it turns";
}

TEST(Channels, HaveNamesOfTheirOwnUnitsAndDescriptions) {
    std::set<std::string> names;
    const model::ChainModel chain = model::make_chain(tiny_parameters());
    for (const Channel& channel : channels()) {
        EXPECT_TRUE(names.emplace(channel.name).second) << channel.name;
        EXPECT_FALSE(channel.unit.empty()) << channel.name;
        EXPECT_FALSE(channel.description.empty()) << channel.name;
        EXPECT_EQ(channel.width(chain) > 1, !channel.axis.empty()) << channel.name;
    }
}

/// Integrates every channel that has an integral, by the trapezoidal rule over outputs.
class Integrals final : public RunObserver {
public:
    explicit Integrals(const model::Variator& variator) : observer_(variator) {}

    void output(double time, const Workspace& workspace, const Counters& counters) override {
        const Instant now{workspace.observed_by(observer_, time), workspace, counters, 0, observer_};
        for (const Channel& channel : channels()) {
            if (channel.integral() == nullptr) continue;
            Sum& sum = sums[std::string(channel.name)];
            const double power = read(channel, now)[0], integral = read(*channel.integral(), now)[0];
            if (counters.steps == 0) sum.begin = integral;
            sum.by_outputs += 0.5 * (time - before_) * (power + sum.power);
            sum.scale += (time - before_) * std::abs(power);
            sum.power = power;
            sum.change = integral - sum.begin;
        }
        before_ = time;
    }
    void transition(const TransitionRecord&) override {}

    struct Sum {
        double begin = 0.0, change = 0.0, by_outputs = 0.0, scale = 0.0, power = 0.0;
    };
    std::map<std::string, Sum> sums;

private:
    model::Observer observer_;
    double before_ = 0.0;
};

/// Means of sums so far, and of means since the last output, would be neither.
TEST(Channels, SumsAreLeftAsTheyAreByMeansOfOutputs) {
    long sums = 0;
    for (const Channel& channel : channels()) {
        const bool stated = channel.description.find(" so far") != std::string_view::npos ||
                            channel.description.find("since the last output") != std::string_view::npos;
        EXPECT_TRUE(!stated || channel.is(Channel::unaveraged)) << channel.name;
        sums += stated ? 1 : 0;
        const Channel* integral = channel.integral();
        EXPECT_TRUE(integral == nullptr || integral->is(Channel::unaveraged)) << channel.name;
    }
    EXPECT_GT(sums, 40);
}

/// Losses are known from samples every 24 steps, and a mean torque since the output before lies half an interval behind: a hundredth each
/// over 200 outputs.
TEST(Channels, HaveTheirIntegralWhereTheyNameOne) {
    for (const Channel& channel : channels()) {
        const Channel* integral = channel.integral();
        EXPECT_TRUE(integral == nullptr || integral->is(Channel::without_chain)) << channel.name;
    }
    Scene scene = test::settled_tiny({"run.step=100 ns", "run.output_interval=1 us"});
    Simulation simulation(scene);
    Integrals integrals(simulation.workspace().variator);
    const engine::Cancellation never;
    ASSERT_FALSE(simulation.advance({.until = 2e-4}, integrals, never));
    EXPECT_GT(integrals.sums.size(), 20u);
    for (const auto& [name, sum] : integrals.sums) EXPECT_NEAR(sum.change, sum.by_outputs, 0.03 * sum.scale + 1e-15) << name;
}

TEST(Channels, ThereIsOneForEveryLossEnergyAndWork) {
    std::set<std::string> names;
    for (const Channel& channel : channels()) names.emplace(channel.name);
    for (int kind = 0; kind < model::loss_kinds; ++kind) EXPECT_TRUE(names.contains("loss/" + std::string(loss_name(kind))));
    for (int kind = 0; kind < model::energy_kinds; ++kind) EXPECT_TRUE(names.contains("energy/" + std::string(energy_name(kind))));
    for (int kind = 0; kind < model::work_kinds; ++kind) EXPECT_TRUE(names.contains("power/" + std::string(work_name(kind))));
}

}  // namespace
}  // namespace cvtflow::tasks
