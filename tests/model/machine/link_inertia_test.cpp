#include "model/machine/link_inertia.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>
#include <vector>

#include "model/basis/portable_math.hpp"
#include "model/kernels/link_lanes.hpp"

namespace cvtflow::model {
namespace {

/// Coordinates of a link along x, or along y.
constexpr int lateral_size = 2 * axis_terms;

template <class Check>
void for_every_detail(const Check& check) {
    for (const PlateDetail plates : {PlateDetail::each, PlateDetail::lumped}) {
        Parameters p;
        p.detail.plates = plates;
        check(p);
    }
}

/// Accelerations of one link, in place of its forces.
void accelerate_one(const LinkInertia& inertia, std::vector<double>& f) {
    std::vector<Lanes<1>> lane(f.begin(), f.end());
    accelerate(inertia, lane.data());
    for (std::size_t k = 0; k < f.size(); ++k) f[k] = lane[k][0];
}

/// matrix · v for blocks of `size`.
std::vector<double> times(const double* matrix, int size, const double* v) {
    std::vector<double> product(static_cast<std::size_t>(size), 0.0);
    for (int row = 0; row < size; ++row) {
        for (int column = 0; column < size; ++column) product[static_cast<std::size_t>(row)] += matrix[row * size + column] * v[column];
    }
    return product;
}

/// Condition numbers are below 100, a few hundred roundings of 1.
TEST(LinkInertia, SolvingInvertsTheMatrix) {
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    for_every_detail([&](const Parameters& p) {
        const LinkInertia inertia = link_inertia(p);
        constexpr int size = lateral_size;
        std::vector<double> f(2 * size + 4), back;
        for (double& value : f) value = any(random);
        std::vector<double> a = f;
        accelerate_one(inertia, a);
        for (int block = 0; block < 2; ++block) {
            const auto of_block = times(inertia.lateral_matrix.data(), size, a.data() + block * size);
            back.insert(back.end(), of_block.begin(), of_block.end());
        }
        const auto axial = times(inertia.axial_matrix.data(), 4, a.data() + 2 * size);
        back.insert(back.end(), axial.begin(), axial.end());
        for (std::size_t k = 0; k < f.size(); ++k) EXPECT_NEAR(back[k], f[k], 1e-14) << k;
    });
}

/// Kinetic energy of the mass distribution itself: halves as uniform lines, plates as uniform bars between them, by quadrature.
double plain_kinetic_energy(const Parameters& p, const std::vector<double>& a, const std::vector<double>& b) {
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
    for_every_detail([&](const Parameters& p) {
        const LinkInertia inertia = link_inertia(p);
        std::vector<double> a(axis_terms), b(axis_terms), v;
        for (double& value : a) value = any(random);
        for (double& value : b) value = any(random);
        v = a;
        v.insert(v.end(), b.begin(), b.end());
        const auto momentum = times(inertia.lateral_matrix.data(), lateral_size, v.data());
        double energy = 0.0;
        for (std::size_t k = 0; k < v.size(); ++k) energy += 0.5 * v[k] * momentum[k];
        EXPECT_NEAR(energy, plain_kinetic_energy(p, a, b), 1e-16);  // ~1e-2 J, some ten roundings
    });
}

}  // namespace
}  // namespace cvtflow::model
