/// Recipe "a force element": the damper of damper.hpp, compiled into the kernels of both chains. What it does to a motion is the same in
/// the step of the default, whose kernels are in floats, and in that of RK4, whose kernels are in doubles.

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/claims/rig_fixture.hpp"
#include "tests/oracle/oracle_cases.hpp"
#include "tests/recipes/damper.hpp"

namespace cvtflow::recipes {
namespace {

/// The kernels that have the damper, before any others are chosen.
const int chosen = setenv("CVTFLOW_ISA", std::string(name_of(model::CVTFLOW_FURTHER_ISA)).c_str(), 1);

/// A ring without pulleys whose pins were pushed.
model::Parameters ring(bool rigid) {
    model::Parameters p = oracle::small_scene();
    p.detail.pulleys = model::PulleyDetail::absent;
    p.start.layout = model::StartLayout::ring;
    return rigid ? oracle::with_rigid_pins(p) : p;
}

/// Velocities of the chain after 4 us. @param damping [N·s/m]
std::vector<double> velocities(bool rigid, const std::string& method, double step, double damping) {
    model::damping_of_example = damping;
    claims::Rig rig(ring(rigid), 1, method);
    const model::ChainLayout& at = rig.variator().layout();
    claims::jolt(at, rig.mutable_state());
    EXPECT_FALSE(rig.run({0.0, 4e-6, step, 4e-6}));
    std::vector<double> found;
    for (int k = 0; k < at.pulley_begin(); ++k)
        if (k % at.link_block() >= at.link_size()) found.push_back(rig.state()[k]);
    return found;
}

class ForceRecipe : public ::testing::TestWithParam<bool> {};

TEST_P(ForceRecipe, ChangesTheDefaultsStepAsItChangesThatOfRk4) {
    const std::string method = GetParam() ? "leapfrog-rigid" : "leapfrog-sweep";
    const auto changed = [&](const std::string& name, double step) {
        std::vector<double> with = velocities(GetParam(), name, step, 100.0);
        const std::vector<double> without = velocities(GetParam(), name, step, 0.0);
        std::ranges::transform(with, without, with.begin(), std::minus<>());
        return with;
    };
    const std::vector<double> expected = changed("rk4", 1e-8), found = changed(method, 5e-8);
    EXPECT_LT(claims::distance(found, expected), 0.05 * claims::distance(expected, std::vector<double>(expected.size())));
}

INSTANTIATE_TEST_SUITE_P(BothChains, ForceRecipe, ::testing::Bool(), [](const auto& of) { return of.param ? "rigid" : "halves"; });

}  // namespace
}  // namespace cvtflow::recipes
