#include "tasks/channel/channels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <string>

#include "tests/claims/operating_point_fixture.hpp"
#include "tests/claims/rig_fixture.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

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
            const bool defined = channel.name.find("efficiency") == std::string_view::npos;  // while it settles more is lost than comes in
            for (const double value : values) EXPECT_EQ(std::isfinite(value), defined) << channel.name;
        }
    }
}

TEST(Channels, AllAreFiniteAndOfTheirWidth) {
    claims::Rig variator(tiny_parameters());
    ASSERT_FALSE(variator.run({-10e-3, -8e-3, 5e-8, 1e-4}));
    expect_finite(variator, true);
    model::Parameters p = tiny_parameters();
    p.detail.pulleys = model::PulleyDetail::absent;
    p.start.layout = model::StartLayout::ring;
    claims::Rig ring(p);
    ASSERT_FALSE(ring.run({0.0, 1e-5, 5e-8, 1e-5}));
    expect_finite(ring, false);
}

/// The observer has never read the chain: quantities of the chain would be zero.
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

/// A record names a dimension after its axis.
TEST(Channels, HaveNamesOfTheirOwnUnitsDescriptionsAndOneWidthPerAxis) {
    std::set<std::string> names;
    std::map<std::string_view, int> widths;
    const model::ChainModel chain = model::make_chain(tiny_parameters());
    for (const Channel& channel : channels()) {
        EXPECT_TRUE(names.emplace(channel.name).second) << channel.name;
        EXPECT_FALSE(channel.unit.empty()) << channel.name;
        EXPECT_FALSE(channel.description.empty()) << channel.name;
        const int width = channel.width(chain);
        EXPECT_EQ(width > 1, !channel.axis.empty()) << channel.name;
        EXPECT_TRUE(channel.axis.empty() || widths.try_emplace(channel.axis, width).first->second == width) << channel.name;
    }
    for (int kind = 0; kind < model::loss_kinds; ++kind) EXPECT_TRUE(names.contains("loss/" + std::string(loss_name(kind))));
    for (int kind = 0; kind < model::energy_kinds; ++kind) EXPECT_TRUE(names.contains("energy/" + std::string(energy_name(kind))));
    for (int kind = 0; kind < model::work_kinds; ++kind) EXPECT_TRUE(names.contains("power/" + std::string(work_name(kind))));
}

/// Means of sums so far, of means since the last output, and of energies that close a balance with sums, would be neither.
TEST(Channels, SumsAreLeftAsTheyAreByMeansOfOutputs) {
    long sums = 0;
    for (const Channel& channel : channels()) {
        const bool stated = channel.description.find(" so far") != std::string_view::npos ||
                            channel.description.find("since the last output") != std::string_view::npos ||
                            channel.name.starts_with("energy/");
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
    Simulation simulation(test::settled_tiny({"run.step=100 ns", "run.output_interval=1 us"}));
    struct Sum {
        double begin = 0.0, change = 0.0, by_outputs = 0.0, scale = 0.0, power = 0.0;
    };
    std::map<std::string, Sum> sums;
    model::Observer observer(simulation.workspace().variator);
    double before = 0.0;
    Outputs integrals([&](double time, const Workspace& workspace, const Counters& counters) {  // by the trapezoidal rule
        const Instant now{workspace.observed_by(observer, time), workspace, counters, 0, observer};
        for (const Channel& channel : channels()) {
            if (channel.integral() == nullptr) continue;
            Sum& sum = sums[std::string(channel.name)];
            const double power = read(channel, now)[0], integral = read(*channel.integral(), now)[0];
            if (counters.steps == 0) sum.begin = integral;
            sum.by_outputs += 0.5 * (time - before) * (power + sum.power);
            sum.scale += (time - before) * std::abs(power);
            sum.power = power;
            sum.change = integral - sum.begin;
        }
        before = time;
    });
    settle_and_go(simulation, 2e-4, integrals);
    EXPECT_GT(sums.size(), 20u);
    for (const auto& [name, sum] : sums) EXPECT_NEAR(sum.change, sum.by_outputs, 0.03 * sum.scale + 1e-15) << name;
}

const Channel& named(std::string_view name) {
    const auto all = channels();
    return *std::find_if(all.begin(), all.end(), [&](const Channel& channel) { return channel.name == name; });
}

TEST(ForceChannels, AreRecordedWhereTheyAreNamedAlone) {
    const model::Parameters variator;
    model::Parameters ring;
    ring.detail.pulleys = model::PulleyDetail::absent;
    const auto has = [](const std::vector<const Channel*>& chosen, std::string_view name) {
        return std::any_of(chosen.begin(), chosen.end(), [&](const Channel* channel) { return channel->name == name; });
    };
    const std::vector<std::string> names{"tips/*", "joints/normal_force"};
    const auto usual = chosen_channels({}, variator), some = chosen_channels(names, variator), of_ring = chosen_channels(names, ring);
    EXPECT_TRUE(std::all_of(usual.begin(), usual.end(), [](const Channel* channel) { return !channel->is(Channel::on_demand); }));
    EXPECT_EQ(some.size(), usual.size() + 4);
    EXPECT_TRUE(has(some, "tips/radial_force") && has(some, "joints/normal_force") && !has(some, "joints/friction_force"));
    EXPECT_TRUE(has(of_ring, "joints/normal_force") && !has(of_ring, "tips/radial_force"));
}

TEST(ForceChannels, NamesThatMeanNothingAreFound) {
    const std::vector<std::string> names{"tips/*", "tip/*", "ratio", "rattio", "*"};
    EXPECT_EQ(unknown_channels(names), (std::vector<std::string>{"tip/*", "rattio", "*"}));
}

/// Means of channels at the outputs of a run from a settled state.
class Means {
public:
    explicit Means(const Scene& scene) : simulation_(scene), observer_(simulation_.workspace().variator) {
        Outputs outputs([this](double time, const Workspace& workspace, const Counters& counters) { add(time, workspace, counters); });
        settle_and_go(simulation_, scene.run.until, outputs);
    }
    [[nodiscard]] double mean(std::string_view channel, std::size_t index = 0) const { return sums_.at(channel)[index] / outputs_; }
    /// Moments of the tangential forces about their shaft's axis, at the pins' radii.
    [[nodiscard]] double torque(std::size_t shaft) const { return torque_[shaft] / outputs_; }
    [[nodiscard]] double sum(std::string_view channel) const {
        const auto& all = sums_.at(channel);
        return std::accumulate(all.begin(), all.end(), 0.0) / outputs_;
    }

private:
    void add(double time, const Workspace& workspace, const Counters& counters) {
        const Instant instant{workspace.observed_by(observer_, time), workspace, counters, 0, observer_};
        ++outputs_;
        for (const Channel* channel : chosen_channels(all_, workspace.parameters)) {
            const std::vector<double> values = read(*channel, instant);
            auto& sum = sums_[channel->name];
            sum.resize(values.size());
            for (std::size_t i = 0; i < values.size(); ++i) sum[i] += values[i];
        }
        const std::vector<double> tangential = read(named("tips/tangential_force"), instant);
        for (std::size_t tip = 0; tip < tangential.size(); ++tip) {
            const double* link = workspace.state() + workspace.layout().link_begin(static_cast<int>(tip / 4));
            const std::size_t shaft = static_cast<std::size_t>(workspace.variator.chain().shaft_of(link));
            torque_[shaft] += tangential[tip] * instant.observation.radius[shaft];
        }
    }

    Simulation simulation_;
    model::Observer observer_;
    std::vector<std::string> all_{"tips/*", "shaft_1/*",    "shaft_2/*", "plates/*", "contact_thrust_ratio",
                                  "loss/*", "misalignment", "wear/*"};
    std::map<std::string_view, std::vector<double>> sums_;
    std::array<double, 2> torque_{};
    double outputs_ = 0.0;
};

/// Four pin periods of the settled baseline: means against what acts from outside, to 1 %.
TEST(ForceChannels, OfTheBaselineAddUpToClampingTorqueAndTension) {
    const Means run(claims::ready_scene("baseline", {"run.until=2.85 ms", "run.method=dumka3"}));
    EXPECT_NEAR(run.torque(1), 150.0, 1.5);
    EXPECT_NEAR(run.torque(0), run.mean("shaft_1/chain_torque"), 1.5);
    EXPECT_NEAR(run.mean("contact_thrust_ratio"), 27.1 / 20.0, 0.01 * 1.355);
    EXPECT_NEAR(run.mean("shaft_2/safety_factor"), 199.7 / 150.0, 0.02 * 1.33);  // 199.7 N·m: 2 mu S r/cos(beta), at r = 54.4 mm
    EXPECT_NEAR(run.sum("plates/tension"), run.sum("links/tension"), 0.01 * run.sum("links/tension"));
    // The strands pull the shafts together, less the chain's centrifugal force, which the arcs carry themselves.
    const double strands = run.mean("tight_tension") + run.mean("slack_tension");
    const double moving = 2.0 * 2.0 * (4.42e-3 + 7 * 0.65e-3) / 8.12e-3 * std::pow(run.mean("chain_speed"), 2);
    EXPECT_NEAR(run.mean("shaft_1/bearing_force", 0), strands - moving, 0.03 * strands);
    EXPECT_NEAR(run.mean("shaft_2/bearing_force", 0), -(strands - moving), 0.03 * strands);
    EXPECT_NEAR((1.0 - run.mean("shaft_1/slip")) * (1.0 - run.mean("shaft_2/slip")), 1.0 - run.mean("slip"), 1e-5);
    double losses = 0.0;
    for (int kind = 0; kind < model::loss_kinds; ++kind) losses += run.mean("loss/" + std::string(loss_name(kind)));
    EXPECT_NEAR(run.mean("loss/total"), losses, 1e-9 * losses);
    // Rings and tips share out the same friction; friction is at most μ N, and is that where tips slide faster than they saturate.
    const double rubbed = run.mean("loss/tip_friction");
    EXPECT_NEAR(run.sum("wear/tip_power"), rubbed, 1e-9 * rubbed);
    EXPECT_NEAR(run.sum("wear/friction_power"), rubbed, 1e-9 * rubbed);
    EXPECT_NEAR(run.sum("wear/force_speed"), run.sum("wear/tip_force_speed"), 1e-9 * run.sum("wear/force_speed"));
    EXPECT_LE(rubbed, 0.09 * run.sum("wear/force_speed"));
    EXPECT_GT(rubbed, 0.05 * run.sum("wear/force_speed"));
    // The chain runs on 54.4 mm: everything is in the rings around it, 32 from 25 to 80 mm.
    double near = 0.0;
    for (std::size_t sheave = 0; sheave < 4; ++sheave)
        for (const std::size_t ring : {16u, 17u, 18u}) near += run.mean("wear/friction_power", 32 * sheave + ring);
    EXPECT_NEAR(near, rubbed, 1e-9 * rubbed);
}

}  // namespace
}  // namespace cvtflow::tasks
