/// Claims about the stability of methods that are programs and not tables, against theory. As a command: cvtflow-lab stability leapfrog-rkc
/// leapfrog-sweep …

#include "bench/method/stability/program_stability.hpp"
#include "bench/method/laboratory_methods.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tasks/method/method.hpp"

namespace cvtflow::claims {
namespace {

using bench::ProgramStability;
using bench::TestEquation;
using tasks::MethodProgram;

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
    EXPECT_EQ(programs_for(TestEquation::oscillator).size(), 7U)
        << "with stages by RKC and Chebyshev, with sweeps, each also in double; rigid pins";
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
