/// The spectrum of the variator (design check 10.6): where its stiffness comes from.

#include "tasks/spectrum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/claims/operating_point_fixture.hpp"

namespace cvtflow::claims {
namespace {

struct Extent {
    double fastest_decay;        ///< max -Re λ [1/s]
    double fastest_oscillation;  ///< max |Im λ| [1/s]
};

class Quiet final : public tasks::RunObserver {
    void output(double, const tasks::Workspace&, const tasks::Counters&) override {}
    void transition(const tasks::TransitionRecord&) override {}
};

/// A scene brought to a running state, whose spectrum can be taken with other friction.
class Running {
public:
    explicit Running(const tasks::Scene& scene) : parameters_(scene.parameters), simulation_(scene) {
        Quiet quiet;
        const engine::Cancellation never;
        if (simulation_.needs_settling()) {
            EXPECT_FALSE(simulation_.settle(quiet, never));
        }
        EXPECT_FALSE(simulation_.run(simulation_.time() + 1e-5, quiet, never));
        state_.assign(simulation_.state(), simulation_.state() + simulation_.variator().layout().size());
    }
    [[nodiscard]] model::Parameters parameters() const { return parameters_; }
    [[nodiscard]] Extent extent(const model::Parameters& parameters) const {
        const model::Variator variator(parameters);
        Extent extent{0.0, 0.0};
        for (const auto& value : tasks::spectrum(variator, simulation_.time(), state_, simulation_.phases())) {
            extent.fastest_decay = std::max(extent.fastest_decay, -value.real());
            extent.fastest_oscillation = std::max(extent.fastest_oscillation, std::abs(value.imag()));
        }
        return extent;
    }

private:
    model::Parameters parameters_;
    tasks::Simulation simulation_;
    std::vector<double> state_;
};

TEST(Spectrum, EachKindOfFrictionHasItsOwnBandInverselyProportionalToItsSaturationSpeed) {
    const Running tiny(ready_scene("tiny"));
    using Kind = model::Friction& (*)(model::Parameters&);
    const Kind kinds[] = {[](model::Parameters& p) -> model::Friction& { return p.joint.friction; },
                          [](model::Parameters& p) -> model::Friction& { return p.plate.friction; },
                          [](model::Parameters& p) -> model::Friction& { return p.tip.friction; }};
    for (const Kind chosen : kinds) {
        model::Parameters alone = tiny.parameters();
        for (const Kind kind : kinds) {
            if (kind != chosen) kind(alone).coefficient = 0.0;
        }
        const double fast = tiny.extent(alone).fastest_decay;
        chosen(alone).saturation_speed *= 10.0;
        const double slow = tiny.extent(alone).fastest_decay;
        // 10 but for the structural damping that adds to the decay, and contacts that saturate at the smaller speed only.
        EXPECT_NEAR(fast / slow, 10.0, 2.0);
    }
}

TEST(Spectrum, ItsImaginaryPartIsElasticAndDoesNotKnowTheFriction) {
    const Running tiny(ready_scene("tiny"));
    const Extent now = tiny.extent(tiny.parameters());
    EXPECT_NEAR(now.fastest_oscillation, 1e6, 0.5e6);   // sqrt(k/m) of joints and plates
    EXPECT_GT(now.fastest_decay, 3e6);
    model::Parameters frictionless = tiny.parameters();
    for (model::Friction* friction : {&frictionless.joint.friction, &frictionless.plate.friction, &frictionless.tip.friction}) friction->coefficient = 0.0;
    EXPECT_NEAR(tiny.extent(frictionless).fastest_oscillation, now.fastest_oscillation, 0.1 * now.fastest_oscillation);
}

TEST(NightlySpectrum, OfTheBaselineIsThePublishedOneAndItsBandsBelongToJointsThenPlatesThenTips) {
    const Running baseline(ready_scene("baseline"));
    model::Parameters parameters = baseline.parameters();
    const Extent now = baseline.extent(parameters);
    EXPECT_GT(now.fastest_decay, 0.5e8);
    EXPECT_LT(now.fastest_decay, 1.0e8);
    EXPECT_NEAR(now.fastest_oscillation, 1e6, 0.3e6);
    parameters.joint.friction.saturation_speed *= 10.0;
    const double without_joints = baseline.extent(parameters).fastest_decay;
    EXPECT_LT(without_joints, 0.6 * now.fastest_decay);   // what is left of the band are plates (about half as fast) and tips
    parameters.plate.friction.saturation_speed *= 10.0;
    const double without_plates = baseline.extent(parameters).fastest_decay;
    EXPECT_LT(without_plates, 0.95 * without_joints);
    parameters.tip.friction.saturation_speed *= 10.0;
    const double without_tips = baseline.extent(parameters).fastest_decay;
    EXPECT_LT(without_tips, 0.5 * without_plates);
    for (const auto& [name, value] : {std::pair{"all", now.fastest_decay}, {"joints", without_joints}, {"plates", without_plates}, {"tips", without_tips}}) {
        RecordProperty(name, std::to_string(value));
    }
}

}  // namespace
}  // namespace cvtflow::claims
