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
    int fast;                    ///< eigenvalues with Re λ < -1e6 1/s
};

/// A scene brought to a running state, whose spectrum can be taken with other friction.
class Running {
public:
    explicit Running(const tasks::Scene& scene) : parameters_(scene.parameters), simulation_(scene) {
        tasks::SilentObserver quiet;
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
        Extent extent{0.0, 0.0, 0};
        for (const auto& value : tasks::spectrum(variator, simulation_.time(), state_, simulation_.phases())) {
            extent.fastest_decay = std::max(extent.fastest_decay, -value.real());
            extent.fastest_oscillation = std::max(extent.fastest_oscillation, std::abs(value.imag()));
            extent.fast += value.real() < -1e6 ? 1 : 0;
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

TEST(NightlySpectrum, OfTheBaselineIsThePublishedOneAndItsBandsBelongToJointsPlatesAndTips) {
    const Running baseline(ready_scene("baseline"));
    model::Parameters parameters = baseline.parameters();
    std::vector<Extent> extents{baseline.extent(parameters)};
    for (model::Friction* friction : {&parameters.joint.friction, &parameters.plate.friction, &parameters.tip.friction}) {
        friction->saturation_speed *= 10.0;
        extents.push_back(baseline.extent(parameters));
    }
    for (std::size_t k = 0; k < extents.size(); ++k) {
        RecordProperty("decay_" + std::to_string(k), std::to_string(extents[k].fastest_decay));
        RecordProperty("fast_" + std::to_string(k), extents[k].fast);
    }
    EXPECT_GT(extents[0].fastest_decay, 0.5e8);
    EXPECT_LT(extents[0].fastest_decay, 1.0e8);
    EXPECT_NEAR(extents[0].fastest_oscillation, 1e6, 0.3e6);
    // Joints hold the fastest eigenvalues and a band of them: slowed tenfold, they leave the largest to the tips, and a hundred fewer beyond 1e6 1/s.
    EXPECT_LT(extents[1].fastest_decay, 0.6 * extents[0].fastest_decay);
    EXPECT_LT(extents[1].fast, extents[0].fast - 60);
    // Plates hold a band too, but none of the largest.
    EXPECT_LT(extents[2].fast, extents[1].fast - 20);
    EXPECT_NEAR(extents[2].fastest_decay, extents[1].fastest_decay, 0.01 * extents[1].fastest_decay);
    // Tips are so fast (an end of a pin of order 3 weighs a sixteenth of it) that slowed tenfold they still decay faster than 1e6 1/s: the number hardly
    // falls (measured: 542 to 538), but the largest does. All three together divide it by about ten.
    EXPECT_LE(extents[3].fast, extents[2].fast);
    EXPECT_LT(extents[3].fastest_decay, 0.3 * extents[2].fastest_decay);
    EXPECT_NEAR(extents[0].fastest_decay / extents[3].fastest_decay, 10.0, 3.0);
}

}  // namespace
}  // namespace cvtflow::claims
