/// How friction is shared by the two sheaves of a pulley (docs/friction_wear.md).

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "tests/claims/operating_point_fixture.hpp"

namespace cvtflow::claims {
namespace {

/// Mean friction of the tips on sheaves 1-, 1+, 2-, 2+, over 30 ms after settling [W].
class SheaveFriction final : public tasks::RunObserver {
public:
    explicit SheaveFriction(const tasks::Scene& scene) : simulation_(scene), observer_(simulation_.workspace().variator) {
        tasks::SilentObserver settling;
        EXPECT_FALSE(simulation_.advance({.until = 0.0}, settling, engine::Cancellation()));
        EXPECT_FALSE(simulation_.advance({.until = scene.run.until}, *this, engine::Cancellation()));
        EXPECT_GT(outputs_, 1000.0);
        for (double& power : mean) power /= outputs_;
    }
    void output(double time, const tasks::Workspace& workspace, const tasks::Counters&) override {
        (void)workspace.observed_by(observer_, time);
        const model::ChainModel& chain = workspace.variator.chain();
        const auto& power = observer_.forces().chain.tip_power;
        for (std::size_t tip = 0; tip < power.size(); ++tip) {
            const int link = static_cast<int>(tip) / model::tips_per_link;
            const int shaft = chain.shaft_of(workspace.state() + chain.layout().link_begin(link));
            mean[2 * static_cast<std::size_t>(shaft) + tip % 2] += power[tip];
        }
        ++outputs_;
    }
    void transition(const tasks::TransitionRecord&) override {}
    std::array<double, 4> mean{};

private:
    tasks::Simulation simulation_;
    model::Observer observer_;
    double outputs_ = 0.0;
};

std::array<double, 4> friction_with(const std::string& misalignment) {
    return SheaveFriction(scene_at_level("baseline", "rigid",
                                         {"load.torque=120", "start.settling_time=40 ms", "run.until=30 ms", "run.output_interval=20 us",
                                          "imperfection.misalignment=" + misalignment}))
        .mean;
}

/// Clamping moves the grooves of a perfect machine apart by 68 um, and a chain that runs askew rubs more on one side of each pulley. A
/// misalignment that brings the grooves back in line makes both sides alike, and twice that mirrors them.
TEST(SheaveFriction, IsSharedEvenlyWhereTheGroovesAreInLine) {
    const auto perfect = friction_with("0"), in_line = friction_with("-0.068 mm"), mirrored = friction_with("-0.136 mm");
    for (const std::size_t k : {0u, 2u}) {
        EXPECT_NEAR(in_line[k], in_line[k + 1], 0.03 * in_line[k]) << "pulley " << k / 2 + 1;
        EXPECT_NEAR(perfect[k], mirrored[k + 1], 0.06 * perfect[k]) << "pulley " << k / 2 + 1;
        EXPECT_NEAR(perfect[k + 1], mirrored[k], 0.06 * perfect[k]) << "pulley " << k / 2 + 1;
    }
    EXPECT_GT(perfect[1], 1.3 * perfect[0]);
    EXPECT_GT(perfect[2], 1.2 * perfect[3]);
}

}  // namespace
}  // namespace cvtflow::claims
