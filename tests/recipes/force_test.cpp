/// Recipe "a force element": a force that is the gradient of an energy, and the tests that every element has.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace cvtflow::recipes {
namespace {

/// A spring with damper between two points of the plane, as an element of model/force is written: the state's part in, forces and account
/// out.
struct Strut {
    double stiffness = 1e4;  ///< [N/m]
    double damping = 2.0;    ///< [N·s/m]
    double length = 0.1;     ///< unstretched [m]

    struct Result {
        std::array<double, 2> force;  ///< on the second point [N]; the first has the opposite one
        double energy;                ///< stored [J]
        double loss;                  ///< dissipated, ≥ 0 [W]
    };

    /// @param offset of the second point from the first [m]   @param velocity of that offset [m/s]
    [[nodiscard]] Result operator()(const std::array<double, 2>& offset, const std::array<double, 2>& velocity) const {
        const double distance = std::hypot(offset[0], offset[1]);
        const std::array<double, 2> direction{offset[0] / distance, offset[1] / distance};
        const double stretch = distance - length, rate = direction[0] * velocity[0] + direction[1] * velocity[1];
        const double tension = stiffness * stretch + damping * rate;
        return {{-tension * direction[0], -tension * direction[1]}, 0.5 * stiffness * stretch * stretch, damping * rate * rate};
    }
};

TEST(ForceRecipe, TheElasticPartIsTheGradientOfTheEnergy) {
    const Strut strut;
    const std::array<double, 2> offset{0.08, 0.07}, rest{0.0, 0.0};
    for (std::size_t axis = 0; axis < 2; ++axis) {
        constexpr double step = 1e-6;
        auto up = offset, down = offset;
        up[axis] += step;
        down[axis] -= step;
        const double gradient = (strut(up, rest).energy - strut(down, rest).energy) / (2.0 * step);
        EXPECT_NEAR(strut(offset, rest).force[axis], -gradient, 1e-5) << axis;  // forces of 50 N: differences leave 1e-16 J over 1e-6 m
    }
}

TEST(ForceRecipe, PowerIsChangeOfEnergyAndLoss) {
    const Strut strut;
    const std::array<double, 2> offset{0.08, 0.07}, velocity{0.3, -0.5};
    const auto now = strut(offset, velocity);
    constexpr double step = 1e-6;
    const auto moved = [&](double time) {
        return strut({offset[0] + time * velocity[0], offset[1] + time * velocity[1]}, velocity).energy;
    };
    const double rate = (moved(step) - moved(-step)) / (2.0 * step);
    const double power = now.force[0] * velocity[0] + now.force[1] * velocity[1];
    EXPECT_NEAR(power, -rate - now.loss, 1e-5);
    EXPECT_GE(now.loss, 0.0);
}

}  // namespace
}  // namespace cvtflow::recipes
