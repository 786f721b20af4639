#include "model/machine/link_inertia.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "model/basis/portable_math.hpp"

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

namespace {

/// Basis values at ξ: of a half's or pin's axis, and of (z, e).
struct AxisBasis {
    Eigen::VectorXd lateral, axial;
};

[[nodiscard]] AxisBasis basis_at(int lateral, double xi) {
    AxisBasis basis{Eigen::VectorXd(lateral), Eigen::Vector2d(1.0, xi)};
    for (int m = 0; m < lateral; ++m) basis.lateral(m) = legendre(m, xi);
    return basis;
}

/// Gives motion relative to the translations of `bodies` bodies `factor` times its inertia: the first basis value of each body moves it as
/// a whole. Rows of translations stay, and with them momentum. (model/EQUATIONS.md section 2)
void scale_relative(Eigen::MatrixXd& matrix, int bodies, double factor) {
    if (factor == 1.0) return;
    const auto size = static_cast<int>(matrix.rows()), each = size / bodies;
    std::vector<int> whole, relative;
    for (int k = 0; k < size; ++k) (k % each == 0 ? whole : relative).push_back(k);
    if (relative.empty()) return;
    const Eigen::MatrixXd coupling = matrix(whole, relative);
    const Eigen::MatrixXd carried = coupling.transpose() * Eigen::MatrixXd(matrix(whole, whole)).llt().solve(coupling);
    const Eigen::MatrixXd own = Eigen::MatrixXd(matrix(relative, relative)) - carried;
    matrix(relative, relative) += 0.5 * (factor - 1.0) * (own + own.transpose());
}

[[nodiscard]] LinkInertia inertia_of(const Eigen::MatrixXd& b, const Eigen::MatrixXd& c) {
    LinkInertia inertia;
    inertia.lateral = invert(b);
    inertia.axial = invert(c);
    keep(b, inertia.lateral_matrix);
    keep(c, inertia.axial_matrix);
    return inertia;
}

}  // namespace

LinkInertia link_inertia(const Parameters& p) {
    const ChainLayout layout = layout_of(p);
    const int lateral = layout.lateral(), bodies = layout.bodies();
    const double body = 2.0 / bodies * p.half.mass;
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(bodies * lateral, bodies * lateral);
    Eigen::MatrixXd c = Eigen::MatrixXd::Zero(2 * bodies, 2 * bodies);
    for (int end = 0; end < bodies; ++end) {
        for (int m = 0; m < lateral; ++m) b(end * lateral + m, end * lateral + m) = body / (2 * m + 1);
        c(2 * end, 2 * end) = body;
        c(2 * end + 1, 2 * end + 1) = body / 3.0;
    }
    const std::vector<double> positions = plate_positions(p);
    const double mass = p.plate.count * p.plate.mass / static_cast<double>(positions.size());
    for (const double xi : positions) {
        const AxisBasis basis = basis_at(lateral, xi);
        if (bodies == 2) {
            add_plate(b, basis.lateral, mass);
            add_plate(c, basis.axial, mass);
        } else {  // half of those behind and half of those before the pin
            b += mass * basis.lateral * basis.lateral.transpose();
            c += mass * basis.axial * basis.axial.transpose();
        }
    }
    for (Eigen::MatrixXd* matrix : {&b, &c}) scale_relative(*matrix, bodies, p.detail.mass_scaling);
    if (layout.rigid) {  // plates move with x_0; each half has half of the mass
        b = Eigen::Vector3d(b(0, 0), b(1, 1), rigid_bending_inertia * p.detail.mass_scaling * body / 5.0).asDiagonal();
        c = Eigen::Vector2d(c(0, 0), 0.25 * c(0, 0)).asDiagonal();
    }
    return inertia_of(b, c);
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

template <int Lateral, int Axial>
[[nodiscard]] double kinetic_of(const LinkInertia& inertia, const double* v) noexcept {
    const double* matrix = inertia.lateral_matrix.data();
    return 0.5 *
           (form<Lateral>(matrix, v) + form<Lateral>(matrix, v + Lateral) + form<Axial>(inertia.axial_matrix.data(), v + 2 * Lateral));
}

}  // namespace

double kinetic_energy(const LinkInertia& inertia, const double* v) noexcept {
    if (inertia.axial.size == 2) return kinetic_of<3, 2>(inertia, v);  // rigid pins
    switch (inertia.lateral.size) {
        case 2: return kinetic_of<2, 4>(inertia, v);
        case 4: return kinetic_of<4, 4>(inertia, v);
        case 6: return kinetic_of<6, 4>(inertia, v);
        default: return kinetic_of<8, 4>(inertia, v);
    }
}

}  // namespace cvtflow::model
