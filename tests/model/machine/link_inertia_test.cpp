#include "model/machine/link_solve.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "model/basis/legendre.hpp"
#include "model/start/start_state.hpp"

namespace cvtflow::model {
namespace {

Parameters scene(int order, PlateDetail plates) {
    Parameters p;
    p.detail.order = order;
    p.detail.plates = plates;
    return p;
}

template <class Check>
void for_every_detail(const Check& check) {
    for (const PlateDetail plates : {PlateDetail::each, PlateDetail::lumped}) {
        check.template operator()<0>(scene(0, plates));
        check.template operator()<1>(scene(1, plates));
        check.template operator()<2>(scene(2, plates));
        check.template operator()<3>(scene(3, plates));
    }
}

/// matrix · v for blocks of `size`.
std::vector<double> times(const double* matrix, int size, const double* v) {
    std::vector<double> product(static_cast<std::size_t>(size), 0.0);
    for (int row = 0; row < size; ++row) {
        for (int column = 0; column < size; ++column) product[static_cast<std::size_t>(row)] += matrix[row * size + column] * v[column];
    }
    return product;
}

TEST(LinkInertia, IsPositiveDefiniteAndSymmetric) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    for_every_detail([&]<int P>(const Parameters& p) {
        const LinkInertia inertia = link_inertia(p);
        const int size = 2 * (P + 1);
        ASSERT_EQ(inertia.lateral.size, size);
        for (int row = 0; row < size; ++row) {
            EXPECT_GT(inertia.lateral.column[static_cast<std::size_t>(row * padded(size) + row)], 0.0);
            for (int column = 0; column < size; ++column) {
                EXPECT_EQ(inertia.lateral_matrix[static_cast<std::size_t>(row * size + column)],
                          inertia.lateral_matrix[static_cast<std::size_t>(column * size + row)]);
            }
        }
        for (int k = 0; k < 100; ++k) {
            std::vector<double> v(static_cast<std::size_t>(size));
            for (double& value : v) value = any(random);
            const auto momentum = times(inertia.lateral_matrix.data(), size, v.data());
            double energy = 0.0, square = 0.0;
            for (std::size_t i = 0; i < v.size(); ++i) energy += v[i] * momentum[i], square += v[i] * v[i];
            EXPECT_GE(energy, p.half.mass / (2 * P + 1) * square);  // plates only add to the halves' own diagonal
        }
    });
}

TEST(LinkInertia, SolvingInvertsTheMatrix) {
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    for_every_detail([&]<int P>(const Parameters& p) {
        const LinkInertia inertia = link_inertia(p);
        constexpr int size = 2 * (P + 1);
        std::vector<double> f(2 * size + 4);
        for (double& value : f) value = any(random);
        std::vector<double> a = f;
        accelerate<P>(inertia, a.data());
        // Condition numbers are below 100: a few hundred roundings of 1.
        for (int block = 0; block < 2; ++block) {
            const auto back = times(inertia.lateral_matrix.data(), size, a.data() + block * size);
            for (int k = 0; k < size; ++k)
                EXPECT_NEAR(back[static_cast<std::size_t>(k)], f[static_cast<std::size_t>(block * size + k)], 1e-14);
        }
        const auto back = times(inertia.axial_matrix.data(), 4, a.data() + 2 * size);
        for (int k = 0; k < 4; ++k) EXPECT_NEAR(back[static_cast<std::size_t>(k)], f[static_cast<std::size_t>(2 * size + k)], 1e-14);
    });
}

TEST(LinkInertia, WeighsTheWholeLink) {
    for_every_detail([&]<int P>(const Parameters& p) {
        const LinkInertia inertia = link_inertia(p);
        std::vector<double> forward(2 * (P + 1), 0.0);
        forward[0] = forward[P + 1] = 1.0;
        const auto momentum = times(inertia.lateral_matrix.data(), 2 * (P + 1), forward.data());
        EXPECT_NEAR(momentum[0] + momentum[P + 1], link_mass(p), 1e-16);
        const double along[4] = {1.0, 0.0, 1.0, 0.0};
        const auto axial = times(inertia.axial_matrix.data(), 4, along);
        EXPECT_NEAR(axial[0] + axial[2], link_mass(p), 1e-16);
    });
}

/// Kinetic energy of the mass distribution itself: halves as uniform lines, plates as uniform bars between them, by quadrature.
double kinetic_energy(const Parameters& p, const std::vector<double>& a, const std::vector<double>& b) {
    const auto at = [](const std::vector<double>& half, double xi) {
        double value = 0.0;
        for (std::size_t m = 0; m < half.size(); ++m) value += half[m] * legendre(static_cast<int>(m), xi);
        return value;
    };
    const Quadrature rule = gauss_legendre(8);  // exact for the squares of cubics
    double energy = 0.0;
    for (std::size_t g = 0; g < rule.position.size(); ++g) {
        const double xi = rule.position[g];
        energy += 0.5 * p.half.mass * rule.weight[g] * (at(a, xi) * at(a, xi) + at(b, xi) * at(b, xi));
    }
    const auto plates = plate_positions(p);
    for (const double xi : plates) {
        for (std::size_t g = 0; g < rule.position.size(); ++g) {
            const double along = 0.5 * (1.0 + rule.position[g]);  // velocity is linear between both ends
            const double v = (1.0 - along) * at(a, xi) + along * at(b, xi);
            energy += 0.5 * p.plate.mass * p.plate.count / static_cast<double>(plates.size()) * rule.weight[g] * v * v;
        }
    }
    return energy;
}

TEST(LinkInertia, IsTheKineticEnergyOfItsMasses) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    for_every_detail([&]<int P>(const Parameters& p) {
        const LinkInertia inertia = link_inertia(p);
        std::vector<double> a(P + 1), b(P + 1), v;
        for (double& value : a) value = any(random);
        for (double& value : b) value = any(random);
        v = a;
        v.insert(v.end(), b.begin(), b.end());
        const auto momentum = times(inertia.lateral_matrix.data(), 2 * (P + 1), v.data());
        double energy = 0.0;
        for (std::size_t k = 0; k < v.size(); ++k) energy += 0.5 * v[k] * momentum[k];
        EXPECT_NEAR(energy, kinetic_energy(p, a, b), 1e-16);  // ~1e-2 J, some ten roundings
    });
}

}  // namespace
}  // namespace cvtflow::model
