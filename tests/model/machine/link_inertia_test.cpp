#include "model/machine/link_inertia.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>
#include <vector>

#include "model/basis/portable_math.hpp"
#include "model/kernels/link_lanes.hpp"
#include "model/start/start_state.hpp"

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

/// Condition numbers are below 100, a few hundred roundings of 1; with mass scaling below 3000.
TEST(LinkInertia, SolvingInvertsTheMatrix) {
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    for (const auto& [scaling, tolerance] : {std::pair{1.0, 1e-14}, {30.0, 1e-12}}) {
        for_every_detail([&, scaling = scaling, tolerance = tolerance](Parameters p) {
            p.detail.mass_scaling = scaling;
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
            for (std::size_t k = 0; k < f.size(); ++k) EXPECT_NEAR(back[k], f[k], tolerance) << k << ", scaling " << scaling;
        });
    }
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

/// Inertia of one direction as it is and as it is with mass scaling; coordinates that move a half without tilting it come first of each.
struct Scaled {
    Eigen::MatrixXd unscaled, slowed;

    [[nodiscard]] int each() const { return static_cast<int>(unscaled.rows()) / 2; }
    [[nodiscard]] std::vector<int> chosen(bool translations) const {
        std::vector<int> list;
        for (int k = 0; k < unscaled.rows(); ++k) {
            if ((k % each() == 0) == translations) list.push_back(k);
        }
        return list;
    }
};

constexpr double factor = 30.0;

/// Checks of x and y, and of z, at every level of detail.
template <class Check>
void for_every_direction(const Check& check) {
    for_every_detail([&](Parameters p) {
        const LinkInertia unscaled = link_inertia(p);
        p.detail.mass_scaling = factor;
        const LinkInertia slowed = link_inertia(p);
        const auto matrix = [](const double* rows, int size) {
            return Eigen::MatrixXd(Eigen::Map<const Eigen::MatrixXd>(rows, size, size));
        };
        check(Scaled{matrix(unscaled.lateral_matrix.data(), unscaled.lateral.size),
                     matrix(slowed.lateral_matrix.data(), unscaled.lateral.size)});
        check(Scaled{matrix(unscaled.axial_matrix.data(), unscaled.axial.size), matrix(slowed.axial_matrix.data(), unscaled.axial.size)});
    });
}

TEST(MassScaling, LeavesMomentumOfEveryTranslationToTheBit) {
    for_every_direction([](const Scaled& of) {
        EXPECT_LT((of.slowed - of.slowed.transpose()).norm(), 1e-15 * of.slowed.norm());
        for (const int row : of.chosen(true)) EXPECT_EQ(of.slowed.row(row), of.unscaled.row(row));
    });
}

/// Energy is ½ p_0·M_00⁻¹ p_0, of the momentum p_0 of the translations, and that of motion without momentum.
TEST(MassScaling, MultipliesTheEnergyOfMotionWithoutMomentum) {
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    int compared = 0;
    for_every_direction([&](const Scaled& of) {
        const std::vector<int> translations = of.chosen(true), relative = of.chosen(false);
        Eigen::VectorXd v = Eigen::VectorXd::NullaryExpr(of.unscaled.rows(), [&] { return any(random); });
        const Eigen::VectorXd momentum = of.unscaled(translations, relative) * v(relative);
        v(translations) = -Eigen::MatrixXd(of.unscaled(translations, translations)).llt().solve(momentum);
        const double expected = factor * v.dot(of.unscaled * v);
        EXPECT_NEAR(v.dot(of.slowed * v), expected, 1e-13 * expected);  // some tens of roundings
        ++compared;
    });
    EXPECT_EQ(compared, 4);  // z, x and y, with both kinds of plates
}

TEST(MassScaling, LowersFrequenciesOfAFreePinByItsSquareRoot) {
    for_every_direction([](const Scaled& of) {
        Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(of.unscaled.rows(), of.unscaled.rows());
        for (const int k : of.chosen(false)) stiffness(k, k) = 1e8 * (1.0 + k);  // springs that hold the pin to itself
        const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> unscaled(stiffness, of.unscaled), slowed(stiffness, of.slowed);
        const double largest = unscaled.eigenvalues().maxCoeff();
        for (Eigen::Index k = 0; k < of.unscaled.rows(); ++k)
            EXPECT_NEAR(factor * slowed.eigenvalues()(k), unscaled.eigenvalues()(k), 1e-12 * largest);  // condition of the matrices: 1e3
    });
}

}  // namespace
}  // namespace cvtflow::model
