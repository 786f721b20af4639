#include "model/machine/link_inertia.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/basis/portable_math.hpp"

namespace cvtflow::model {
namespace {

/// L of a symmetric positive definite matrix A = L L' of at most max_lateral_block rows. Systems are solved four rows at a time: the order
/// of all sums is that of the results that have been published.
template <class Real>
class Cholesky {
public:
    /// Decomposes the lower triangle. @param rows of the matrix
    Cholesky(const double* rows, int size) noexcept : size_(size) {
        using std::sqrt;
        for (int column = 0; column < size; ++column) {
            for (int row = column; row < size; ++row) {
                const Real rest =
                    static_cast<Real>(rows[row * size + column]) - sum(0, column, [&](int k) { return l(row, k) * l(column, k); });
                l(row, column) = row == column ? sqrt(rest) : rest / l(column, column);
            }
        }
    }

    /// v becomes A⁻¹ v.
    void solve(Real* v) const noexcept {
        for (int begin = 0; begin < size_; begin += together) {
            const int end = std::min(begin + together, size_);
            for (int k = begin; k < end; ++k) {
                v[k] *= Real(1) / l(k, k);
                for (int row = k + 1; row < end; ++row) v[row] -= v[k] * l(row, k);
            }
            for (int row = end; row < size_; ++row) v[row] -= sum(begin, end, [&](int k) { return l(row, k) * v[k]; });
        }
        for (int end = size_; end > 0; end -= together) {
            const int begin = std::max(end - together, 0);
            const auto behind = [&](int row, int first) { return sum(first, end, [&](int k) { return l(k, row) * v[k]; }); };
            for (int row = end - 1; row >= begin; --row) v[row] = (v[row] - behind(row, row + 1)) * (Real(1) / l(row, row));
            for (int row = 0; row < begin; ++row) v[row] -= behind(row, begin);
        }
    }

private:
    static constexpr int together = 4;

    template <class Term>
    [[nodiscard]] static Real sum(int first, int last, const Term& term) noexcept {
        Real total = 0;
        for (int k = first; k < last; ++k) total += term(k);
        return total;
    }
    [[nodiscard]] Real& l(int row, int column) noexcept { return l_[static_cast<std::size_t>(row * max_lateral_block + column)]; }
    [[nodiscard]] Real l(int row, int column) const noexcept { return l_[static_cast<std::size_t>(row * max_lateral_block + column)]; }

    int size_;
    std::array<Real, max_lateral_block * max_lateral_block> l_{};
};

/// A small symmetric matrix, row by row.
struct Matrix {
    int size;
    std::vector<double> rows = std::vector<double>(static_cast<std::size_t>(size * size));

    [[nodiscard]] double& operator()(int row, int column) noexcept { return rows[static_cast<std::size_t>(row * size + column)]; }
};

[[nodiscard]] SmallInverse invert(const Matrix& matrix) {
    const WideInverse inverse(matrix.rows.data(), matrix.size);
    SmallInverse small;
    small.size = matrix.size;
    for (int column = 0; column < small.size; ++column) {
        for (int row = 0; row < small.size; ++row)
            small.column[static_cast<std::size_t>(column * padded(small.size) + row)] = static_cast<double>(inverse(row, column));
    }
    return small;
}

/// Adds one plate of `mass` at basis values phi: to both halves as a consistent two-node bar, or to a rigid pin, where it is half of those
/// behind and half of those before it.
void add_plate(Matrix& matrix, const std::vector<double>& phi, double mass) {
    const int n = static_cast<int>(phi.size());
    for (int row = 0; row < matrix.size; ++row) {
        for (int column = 0; column < matrix.size; ++column) {
            const double first = phi[static_cast<std::size_t>(row % n)], second = phi[static_cast<std::size_t>(column % n)];
            const bool same_half = row / n == column / n;
            matrix(row, column) += matrix.size == n ? mass * first * second : mass / (same_half ? 3.0 : 6.0) * (first * second);
        }
    }
}

/// Inertia of a link or a rigid pin. @param b, c blocks B and C
[[nodiscard]] LinkInertia inertia_of(const Matrix& b, const Matrix& c) {
    LinkInertia inertia;
    inertia.lateral = invert(b);
    inertia.axial = invert(c);
    std::ranges::copy(b.rows, inertia.lateral_matrix.begin());
    std::ranges::copy(c.rows, inertia.axial_matrix.begin());
    return inertia;
}

[[nodiscard]] Matrix diagonal(const std::vector<double>& numbers) {
    Matrix matrix{static_cast<int>(numbers.size())};
    for (int k = 0; k < matrix.size; ++k) matrix(k, k) = numbers[static_cast<std::size_t>(k)];
    return matrix;
}

}  // namespace

WideInverse::WideInverse(const double* rows, int size) noexcept : size_(size) {
    const Cholesky<Extended> cholesky(rows, size);
    for (int column = 0; column < size; ++column) {
        Extended* v = columns_.data() + column * size;
        v[column] = 1.0;
        cholesky.solve(v);
    }
}

LinkInertia link_inertia(const Parameters& p) {
    const ChainLayout layout = layout_of(p);
    const int lateral = layout.lateral(), bodies = layout.bodies();
    const double body = 2.0 / bodies * p.half.mass;
    Matrix b{bodies * lateral}, c{2 * bodies};
    for (int end = 0; end < bodies; ++end) {
        for (int m = 0; m < lateral; ++m) b(end * lateral + m, end * lateral + m) = body / (2 * m + 1);
        c(2 * end, 2 * end) = body;
        c(2 * end + 1, 2 * end + 1) = body / 3.0;
    }
    const std::vector<double> positions = plate_positions(p);
    const double mass = p.plate.count * p.plate.mass / static_cast<double>(positions.size());
    for (const double xi : positions) {
        std::vector<double> basis;  // of the axis of a half or pin; of (z, e) it is 1, ξ
        for (int m = 0; m < lateral; ++m) basis.push_back(legendre(m, xi));
        add_plate(b, basis, mass);
        add_plate(c, {1.0, xi}, mass);
    }
    if (layout.rigid) {  // plates move with x_0; each half has half of the mass
        b = diagonal({b(0, 0), b(1, 1), rigid_bending_inertia * body / 5.0});
        c = diagonal({c(0, 0), 0.25 * c(0, 0)});
    }
    return inertia_of(b, c);
}

namespace {

/// v' M v of a symmetric matrix; a row at a time, in registers.
template <int Size>
[[nodiscard]] double form(const double* matrix, const double* v) noexcept {
    double value = 0.0;
    for (int row = 0; row < Size; ++row) {
        double product = 0.0;
        for (int column = 0; column < Size; ++column) product += matrix[column * Size + row] * v[column];
        value += v[row] * product;
    }
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
