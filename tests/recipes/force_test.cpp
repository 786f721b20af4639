/// Recipe "a force element": written once over any number - one link, links side by side, numbers with derivatives - and the tests that
/// every element has.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "bench/method/jacobian/dual_lanes.hpp"
#include "model/force/account.hpp"
#include "model/force/link_frame.hpp"

namespace cvtflow::recipes {
namespace {

using model::End;
using model::Lanes;

/// A spring with damper between the two halves of a link, as model/force/inner.hpp would call it.
struct Strut {
    double stiffness = 1e4;  ///< [N/m]
    double damping = 2.0;    ///< [N·s/m]
    double length = 0.1;     ///< unstretched [m]

    /// Adds to the forces f of a link with coordinates q and velocities v.
    template <int P, bool Observe, class Real>
    void add(const Real* q, const Real* v, Real* f, model::Account* account) const noexcept {
        using std::sqrt;
        constexpr int xa = model::at<P>.x(End::rear, 0), ya = model::at<P>.y(End::rear, 0), xb = model::at<P>.x(End::front, 0),
                      yb = model::at<P>.y(End::front, 0);
        const Real dx = q[xb] - q[xa], dy = q[yb] - q[ya], vx = v[xb] - v[xa], vy = v[yb] - v[ya];
        const Real distance = sqrt(dx * dx + dy * dy), inverse = 1.0 / distance;
        const Real stretch = distance - length, rate = (dx * vx + dy * vy) * inverse;
        const Real along = (stiffness * stretch + damping * rate) * inverse;
        f[xb] -= along * dx;
        f[yb] -= along * dy;
        f[xa] += along * dx;
        f[ya] += along * dy;
        if constexpr (Observe) {
            account->store(model::Energy::inner, 0.5 * stiffness * stretch * stretch);
            account->lose(model::Loss::inner, damping * rate * rate);
        }
    }
};

constexpr int size = model::at<0>.link_size();
using Numbers = std::array<double, size>;

/// A link whose halves are `dx`, `dy` apart, and their relative velocity.
Numbers apart(double dx, double dy) {
    Numbers numbers{};
    numbers[static_cast<std::size_t>(model::at<0>.x(End::rear, 0))] = 0.02;
    numbers[static_cast<std::size_t>(model::at<0>.x(End::front, 0))] = 0.02 + dx;
    numbers[static_cast<std::size_t>(model::at<0>.y(End::front, 0))] = dy;
    return numbers;
}

struct Observed {
    Numbers force{};
    model::Account account;
};
Observed observe(const Numbers& q, const Numbers& v) {
    Observed seen;
    Strut().add<0, true>(q.data(), v.data(), seen.force.data(), &seen.account);
    return seen;
}

TEST(ForceRecipe, TheElasticPartIsTheGradientOfTheEnergy) {
    const Numbers q = apart(0.08, 0.07), rest{};
    for (std::size_t k = 0; k < size; ++k) {
        constexpr double step = 1e-6;
        Numbers up = q, down = q;
        up[k] += step;
        down[k] -= step;
        const double gradient =
            (observe(up, rest).account[model::Energy::inner] - observe(down, rest).account[model::Energy::inner]) / (2.0 * step);
        EXPECT_NEAR(observe(q, rest).force[k], -gradient, 1e-5) << k;  // forces of 50 N: differences leave 1e-16 J over 1e-6 m
    }
}

TEST(ForceRecipe, PowerIsChangeOfEnergyAndLoss) {
    const Numbers q = apart(0.08, 0.07), v = apart(0.3, -0.5);
    const Observed now = observe(q, v);
    constexpr double step = 1e-6;
    const auto moved = [&](double time) {
        Numbers later = q;
        for (std::size_t k = 0; k < size; ++k) later[k] += time * v[k];
        return observe(later, v).account[model::Energy::inner];
    };
    double power = 0.0;
    for (std::size_t k = 0; k < size; ++k) power += now.force[k] * v[k];
    EXPECT_NEAR(power, -(moved(step) - moved(-step)) / (2.0 * step) - now.account[model::Loss::inner], 1e-5);
    EXPECT_GE(now.account[model::Loss::inner], 0.0);
}

TEST(ForceRecipe, LinksSideBySideGetTheBitsOfOne) {
    std::array<Lanes<4>, size> q, v, f;
    f.fill(Lanes<4>(0.0));
    std::array<Numbers, 4> places, rates;
    for (std::size_t link = 0; link < 4; ++link) {
        places[link] = apart(0.08 + 0.01 * static_cast<double>(link), 0.07);
        rates[link] = apart(0.3, -0.5 * static_cast<double>(link));
        for (std::size_t k = 0; k < size; ++k) {
            q[k].set(link, places[link][k]);
            v[k].set(link, rates[link][k]);
        }
    }
    Strut().add<0, false>(q.data(), v.data(), f.data(), nullptr);
    for (std::size_t link = 0; link < 4; ++link) {
        const Observed alone = observe(places[link], rates[link]);
        for (std::size_t k = 0; k < size; ++k) EXPECT_EQ(f[k][link], alone.force[k]) << link << ", " << k;
    }
}

TEST(ForceRecipe, ItsExactJacobianComesFromTheSameLines) {
    using T = model::Dual<2 * size>;
    const Numbers q = apart(0.08, 0.07), v = apart(0.3, -0.5);
    std::array<T, size> place, rate, force;
    for (std::size_t k = 0; k < size; ++k) {
        place[k] = T::variable(q[k], static_cast<int>(k));
        rate[k] = T::variable(v[k], size + static_cast<int>(k));
    }
    Strut().add<0, false>(place.data(), rate.data(), force.data(), nullptr);
    for (std::size_t k = 0; k < size; ++k) {
        constexpr double step = 1e-6;
        Numbers up = q, down = q, faster = v, slower = v;
        up[k] += step, faster[k] += step;
        down[k] -= step, slower[k] -= step;
        for (std::size_t row = 0; row < size; ++row) {
            const double by_place = (observe(up, v).force[row] - observe(down, v).force[row]) / (2.0 * step);
            const double by_rate = (observe(q, faster).force[row] - observe(q, slower).force[row]) / (2.0 * step);
            EXPECT_NEAR(force[row].slope[k], by_place, 1e-4)
                << row << ", " << k;  // 1e4 N/m: second order 1e-8/0.1², rounding 1e-14 N/1e-6 m
            EXPECT_NEAR(force[row].slope[size + k], by_rate, 1e-7) << row << ", " << k;
        }
    }
}

}  // namespace
}  // namespace cvtflow::recipes
