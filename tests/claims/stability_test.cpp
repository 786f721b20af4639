/// Claims about the spectrum of the variator: where its stiffness comes from, and which step of RK4 it allows.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bench/method/analysis/eigenvalues.hpp"
#include "bench/study/run_watch.hpp"
#include "bench/study/spectrum.hpp"
#include "bench/study/stability/stable_step.hpp"
#include "engine/method/catalogue.hpp"
#include "tests/claims/operating_point_fixture.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

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
        if (simulation_.needs_settling()) {
            EXPECT_FALSE(go(simulation_, {.until = 0.0}));
        }
        EXPECT_FALSE(go(simulation_, {.until = simulation_.time() + 1e-5, .new_part = true}));
        state_.assign(simulation_.workspace().state(), simulation_.workspace().state() + simulation_.workspace().layout().size());
    }
    [[nodiscard]] model::Parameters parameters() const { return parameters_; }
    [[nodiscard]] Extent extent(const model::Parameters& parameters) const {
        const model::Variator variator(parameters);
        Extent extent{0.0, 0.0, 0};
        for (const auto& value : bench::spectrum(variator, simulation_.time(), state_, simulation_.workspace().tips.phases)) {
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
    EXPECT_NEAR(now.fastest_oscillation, 1e6, 0.5e6);  // sqrt(k/m) of joints and plates
    EXPECT_GT(now.fastest_decay, 3e6);
    model::Parameters frictionless = tiny.parameters();
    for (model::Friction* friction : {&frictionless.joint.friction, &frictionless.plate.friction, &frictionless.tip.friction})
        friction->coefficient = 0.0;
    EXPECT_NEAR(tiny.extent(frictionless).fastest_oscillation, now.fastest_oscillation, 0.1 * now.fastest_oscillation);
}

/// The baseline at its saved state.
const tasks::FrozenStart& baseline_start() {
    static const tasks::FrozenStart start = bench::frozen_start(tasks::Simulation(ready_scene("baseline")));
    return start;
}

bench::Eigenvalues edge_of(const model::Parameters& parameters) {
    const tasks::FrozenStart& start = baseline_start();
    return bench::extremal_eigenvalues(bench::jacobian(model::Variator(parameters), start.time, start.state, start.phases),
                                       static_cast<int>(start.state.size()), {.first_dimension = 800, .progress = {}})
        .values;
}

TEST(Spectrum, OfTheBaselinePredictsTheLongestStableStepOfRk4WithinFivePercent) {
    const tasks::Scene baseline = ready_scene("baseline");
    const bench::Eigenvalues edge = edge_of(baseline.parameters);
    const bench::Extent extent = bench::extent_of(edge);
    EXPECT_GT(extent.decay, 0.5e8);
    EXPECT_LT(extent.decay, 1.0e8);
    EXPECT_NEAR(extent.oscillation, 0.9e6, 0.2e6);
    EXPECT_NEAR(extent.below_1e6, 720, 72);  // the trial program's count
    const engine::StagePlan& rk4 = *engine::find_method("rk4");
    const bench::StableStep predicted = bench::largest_stable_step(rk4, edge);
    EXPECT_NEAR(predicted.step * extent.decay, 2.785, 0.001);
    const bench::MeasuredStep measured =
        bench::measured_stable_step(model::Variator(baseline.parameters), rk4, baseline_start(), predicted.step);
    RecordProperty("predicted_ns", std::to_string(1e9 * predicted.step));
    RecordProperty("measured_ns", std::to_string(1e9 * measured.limit()));
    EXPECT_NEAR(measured.limit() / predicted.step, 1.0, 0.05);
}

TEST(NightlySpectrum, OfTheBaselineIsThePublishedOneAndItsBandsBelongToJointsPlatesAndTips) {
    const bench::Attribution found = bench::attribute(ready_scene("baseline").parameters, baseline_start(), -1e6, {});
    std::vector<bench::Extent> one_after_the_other;
    for (const std::size_t k : {0, 1, 4, 5}) one_after_the_other.push_back(bench::extent_of(found.slowed[k].values));
    for (std::size_t k = 0; k < one_after_the_other.size(); ++k) {
        RecordProperty("decay_" + std::to_string(k), std::to_string(one_after_the_other[k].decay));
        RecordProperty("fast_" + std::to_string(k), one_after_the_other[k].below_1e6);
    }
    EXPECT_NEAR(one_after_the_other[0].oscillation, 1e6, 0.3e6);
    // Joints are the fastest; behind them come tips (an end of a pin of order 3 weighs a sixteenth of it), and more slowly plates.
    // Each kind slowed tenfold takes fast eigenvalues away; all three divide the largest by about ten.
    EXPECT_LT(one_after_the_other[1].decay, 0.6 * one_after_the_other[0].decay);
    EXPECT_LT(one_after_the_other[1].below_1e6, one_after_the_other[0].below_1e6 - 20);
    EXPECT_LT(one_after_the_other[2].below_1e6, one_after_the_other[1].below_1e6 - 20);
    EXPECT_LT(one_after_the_other[3].below_1e7, one_after_the_other[2].below_1e7 - 20);
    EXPECT_NEAR(one_after_the_other[0].decay / one_after_the_other[3].decay, 10.0, 3.0);
    EXPECT_EQ(found.main_kind(0), 0);  // joints
}

TEST(NightlySpectrum, ExtremalEigenvaluesOfTheBaselineAreThoseOfTheDenseMethod) {
    const model::Parameters parameters = ready_scene("baseline").parameters;
    const tasks::FrozenStart& start = baseline_start();
    const bench::Extent all = bench::extent_of(bench::spectrum(model::Variator(parameters), start.time, start.state, start.phases));
    const bench::Extent edge = bench::extent_of(edge_of(parameters));
    EXPECT_NEAR(edge.decay / all.decay, 1.0, 1e-6);
    EXPECT_NEAR(edge.oscillation / all.oscillation, 1.0, 1e-6);
    EXPECT_EQ(edge.below_1e6, all.below_1e6);
    EXPECT_EQ(edge.below_1e7, all.below_1e7);
    EXPECT_EQ(all.growing, 0);
}

}  // namespace
}  // namespace cvtflow::claims
