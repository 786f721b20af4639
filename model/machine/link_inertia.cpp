#include "model/machine/link_inertia.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "model/basis/legendre.hpp"

namespace cvtflow::model {

namespace {

/// Adds one plate, a consistent two-node bar of `mass` at basis values phi, to the matrix of both halves.
void add_plate(Eigen::MatrixXd& matrix, const Eigen::VectorXd& phi, double mass) {
    const auto n = phi.size();
    const Eigen::MatrixXd product = phi * phi.transpose();
    matrix.topLeftCorner(n, n) += mass / 3.0 * product;
    matrix.bottomRightCorner(n, n) += mass / 3.0 * product;
    matrix.topRightCorner(n, n) += mass / 6.0 * product;
    matrix.bottomLeftCorner(n, n) += mass / 6.0 * product;
}

/// In long double, so that the products with it are as exact as a solve.
SmallInverse invert(const Eigen::MatrixXd& matrix) {
    using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
    const Wide inverse = matrix.cast<long double>().llt().solve(Wide::Identity(matrix.rows(), matrix.cols()));
    SmallInverse small;
    small.size = static_cast<int>(matrix.rows());
    for (int column = 0; column < small.size; ++column) {
        for (int row = 0; row < small.size; ++row) {
            small.column[static_cast<std::size_t>(column * padded(small.size) + row)] = static_cast<double>(inverse(row, column));
        }
    }
    return small;
}

template <std::size_t Size>
void keep(const Eigen::MatrixXd& matrix, std::array<double, Size>& rows) {
    for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
        for (Eigen::Index column = 0; column < matrix.cols(); ++column)
            rows[static_cast<std::size_t>(row * matrix.cols() + column)] = matrix(row, column);
    }
}

}  // namespace

LinkInertia link_inertia(const Parameters& p) {
    const int lateral = p.detail.order + 1;
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(2 * lateral, 2 * lateral);
    Eigen::MatrixXd c = Eigen::MatrixXd::Zero(4, 4);
    for (int end = 0; end < 2; ++end) {
        for (int m = 0; m < lateral; ++m) b(end * lateral + m, end * lateral + m) = p.half.mass / (2 * m + 1);
        c(2 * end, 2 * end) = p.half.mass;
        c(2 * end + 1, 2 * end + 1) = p.half.mass / 3.0;
    }
    const std::vector<double> positions = plate_positions(p);
    const double mass = p.plate.count * p.plate.mass / static_cast<double>(positions.size());
    for (const double xi : positions) {
        Eigen::VectorXd phi(lateral);
        for (int m = 0; m < lateral; ++m) phi(m) = legendre(m, xi);
        add_plate(b, phi, mass);
        add_plate(c, Eigen::Vector2d(1.0, xi), mass);
    }
    LinkInertia inertia;
    inertia.lateral = invert(b);
    inertia.axial = invert(c);
    keep(b, inertia.lateral_matrix);
    keep(c, inertia.axial_matrix);
    return inertia;
}

namespace {

/// v' M v of a symmetric matrix; column by column, which vectors can do without changing the order of any sum.
template <int Size>
[[nodiscard]] double form(const double* matrix, const double* v) noexcept {
    double product[Size]{};
    for (int column = 0; column < Size; ++column) {
        for (int row = 0; row < Size; ++row) product[row] += matrix[column * Size + row] * v[column];
    }
    double value = 0.0;
    for (int row = 0; row < Size; ++row) value += v[row] * product[row];
    return value;
}

template <int Lateral>
[[nodiscard]] double twice_kinetic(const LinkInertia& inertia, const double* v) noexcept {
    const double* matrix = inertia.lateral_matrix.data();
    return form<Lateral>(matrix, v) + form<Lateral>(matrix, v + Lateral) + form<4>(inertia.axial_matrix.data(), v + 2 * Lateral);
}

}  // namespace

double kinetic_energy(const LinkInertia& inertia, const double* v, int lateral) noexcept {
    switch (lateral) {
        case 2: return 0.5 * twice_kinetic<2>(inertia, v);
        case 4: return 0.5 * twice_kinetic<4>(inertia, v);
        case 6: return 0.5 * twice_kinetic<6>(inertia, v);
        default: return 0.5 * twice_kinetic<8>(inertia, v);
    }
}

}  // namespace cvtflow::model
