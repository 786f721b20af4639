/// Claims about stability. The spectrum of the variator: where its stiffness comes from, and which step of RK4 it allows. Methods that are
/// programs and not tables, against theory. As a command: cvtflow-lab stability leapfrog-rkc leapfrog-sweep …

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bench/method/analysis/eigenvalues.hpp"
#include "bench/method/laboratory_methods.hpp"
#include "bench/method/stability/program_stability.hpp"
#include "bench/study/run_watch.hpp"
#include "bench/study/spectrum.hpp"
#include "bench/study/stability/stable_step.hpp"
#include "engine/method/catalogue.hpp"
#include "tasks/method/method.hpp"
#include "tests/claims/operating_point_fixture.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::claims {
namespace {

using bench::ProgramStability;
using bench::TestEquation;
using tasks::MethodProgram;

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

ProgramStability stability(const std::string& name) { return bench::analysis_of(*tasks::find_program(name)).stability(); }

std::vector<MethodProgram> programs_for(TestEquation equation) {
    std::vector<MethodProgram> all;
    for (const MethodProgram& program : tasks::method_programs()) {
        if (bench::analysis_of(program).stability != nullptr && bench::analysis_of(program).stability().equation == equation)
            all.push_back(program);
    }
    return all;
}

TEST(ProgramStability, IsKnownOfAllButThoseThatChooseAmongTables) {
    for (const MethodProgram& program : tasks::method_programs()) {
        const bool chooses = program.name == "dumka3" || program.name == "rkc" || program.name == "rock2" || program.name == "fitted";
        EXPECT_EQ(bench::analysis_of(program).stability == nullptr, chooses) << program.name;
    }
}

/// The numbers that the catalogue declares are those that the analysis finds, to the last digit.
TEST(ProgramStability, ReachIsWhatTheCatalogueDeclares) {
    for (const MethodProgram& program : tasks::method_programs()) EXPECT_EQ(program.reach, bench::derived_reach(program)) << program.name;
}

/// h ω of a leapfrog: 2.
TEST(ProgramStability, OscillationIsLimitedAsByTheExplicitPart) {
    EXPECT_EQ(programs_for(TestEquation::oscillator).size(), 4U) << "with stages by RKC and Chebyshev, with sweeps; rigid pins";
    for (const MethodProgram& program : programs_for(TestEquation::oscillator))
        EXPECT_NEAR(bench::reach(bench::analysis_of(program).stability(), 0.0, 0.0, 1.0, 0.0), 2.0, 0.04) << program.name;
}

/// Effect of friction on that limit. A kick v⁺ = R v + B G + C ΔG of a leapfrog grows, with changing sign, from h² ω² = 2 (1 + R)/(B + 2
/// C) on. Two stages of RKC, with G advanced within the step: R = 1 - y + y²/2, B = 1 - y/2, C = y/4 with y = h c, at least 3. Chebyshev's
/// with R near 0: 2. Backward Euler (sweeps) holds G: 2 (2 + y).
TEST(ProgramStability, FrictionLowersTheLimitOfSome) {
    const std::vector<std::pair<std::string, double>> known{
        {"leapfrog-rkc", std::sqrt(3.0)}, {"leapfrog-chebyshev", std::sqrt(2.0)}, {"leapfrog-sweep", 2.0}, {"leapfrog-rigid", 2.0}};
    for (const auto& [name, oscillation] : known)
        EXPECT_NEAR(bench::limit_with_any_friction(stability(name)).oscillation, oscillation, 0.01 * oscillation) << name;
}

/// Inside the step by stages: to the reach of the longest table. Solved for: however far.
TEST(ProgramStability, FrictionAloneIsStableAsFarAsTheStepHasTablesForIt) {
    for (const MethodProgram& program : programs_for(TestEquation::oscillator)) {
        const ProgramStability s = bench::analysis_of(program).stability();
        const double friction = bench::reach(s, 0.0, 0.0, 0.0, 1.0);
        if (std::isinf(s.longest_decay)) {
            EXPECT_TRUE(std::isinf(friction)) << program.name;
        } else {
            EXPECT_NEAR(friction, s.longest_decay, 1e-6 * friction) << program.name;
            EXPECT_GT(friction, 4e4) << program.name;  // 0.35 s² with damping 10, some 390 stages, a margin of 1.1
        }
    }
}

/// |eigenvalue| = exp(-h c/2) for an oscillator, |R| = exp(h Re λ), up to the order.
TEST(ProgramStability, StepsMultiplyAsTheExactSolutionToTheirOrder) {
    for (const MethodProgram& program : tasks::method_programs()) {
        if (bench::analysis_of(program).stability == nullptr) continue;
        const ProgramStability s = bench::analysis_of(program).stability();
        const auto error = [&](double h) {
            const bool oscillator = s.equation == TestEquation::oscillator;
            return std::abs(oscillator ? s.radius(0.8 * h, 0.5 * h) - std::exp(-0.25 * h)
                                       : s.radius(-0.5 * h, 0.6 * h) - std::exp(-0.5 * h));
        };
        EXPECT_GT(std::log2(error(0.125) / error(0.0625)), program.order + 0.7) << program.name << " " << error(0.125);
    }
}

TEST(ProgramStability, FrictionSolvedForIsDampedAsByBackwardEuler) {
    for (const double z : {0.3, 3.0, 300.0}) EXPECT_NEAR(stability("leapfrog-sweep").stages(z).left, 1.0 / (1.0 + z), 1e-14) << z;
    EXPECT_LT(bench::worst_stages(stability("leapfrog-sweep")).left, 1e-5);
}

/// Stages of friction neither exceed what they start from nor multiply errors by much, unlike those of long stabilised methods.
TEST(ProgramStability, LeapfrogsDoNotMultiplyErrorsOfStages) {
    for (const char* name : {"leapfrog-rkc", "leapfrog-chebyshev", "leapfrog-sweep"}) {
        const bench::StageFigures worst = bench::worst_stages(stability(name));
        EXPECT_LT(worst.growth, 1.0 + 1e-9) << name;
        EXPECT_LT(worst.gain, 10.0) << name;
    }
}

TEST(ProgramStability, WhatSolvesForTheWholeStateIsStableInTheLeftHalfPlane) {
    for (const MethodProgram& program : programs_for(TestEquation::linear)) {
        if (program.name == "w-x3" || program.name == "w-x4") continue;  // A(α)-stable: below
        const ProgramStability s = bench::analysis_of(program).stability();
        for (double y = 0.01; y < 1e5; y *= 1.1) {
            for (const double x : {0.0, -1e-3 * y, -y})
                EXPECT_TRUE(s.stable(x, y)) << program.name << " " << x << " " << y << " " << s.radius(x, y);
        }
    }
    for (const char* name : {"w-x3", "w-x4"}) {
        EXPECT_TRUE(std::isinf(bench::reach(stability(name), 0.0, 0.0, -1.0, 0.0))) << name;
        EXPECT_TRUE(std::isinf(bench::reach(stability(name), 0.0, 0.0, -0.1, std::sqrt(0.99)))) << name;
    }
}

TEST(ProgramStability, TrapezoidalRuleKeepsOscillationsAndWMethodsForgetWhatIsStiff) {
    for (const double y : {0.1, 2.0, 1e3}) EXPECT_NEAR(stability("trapezoidal-full").radius(0.0, y), 1.0, 1e-14);
    EXPECT_GT(bench::worst_stages(stability("trapezoidal-full")).left, 0.99999);
    for (const char* name : {"sw2", "ros34pw2", "w-x2", "w-x3", "w-x4"}) EXPECT_LT(bench::worst_stages(stability(name)).left, 1e-4) << name;
}

}  // namespace
}  // namespace cvtflow::claims
