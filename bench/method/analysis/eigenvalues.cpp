#include "bench/method/analysis/eigenvalues.hpp"

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "model/basis/portable_math.hpp"

namespace cvtflow::bench {

namespace {

/// Sum of the magnitudes in a row and in a column, the diagonal left out.
struct Lengths {
    double row = 0.0, column = 0.0;
};

Lengths lengths(const std::vector<double>& matrix, std::size_t size, std::size_t index) {
    Lengths sums;
    for (std::size_t other = 0; other < size; ++other) {
        if (other == index) continue;
        sums.column += std::abs(matrix[index * size + other]);
        sums.row += std::abs(matrix[other * size + index]);
    }
    return sums;
}

/// The power of 2 that makes a column as long as its row, nearly.
double balancing_factor(const Lengths& sums) {
    if (sums.row == 0.0 || sums.column == 0.0) return 1.0;
    const double factor = std::exp2(std::round(0.5 * std::log2(sums.row / sums.column)));
    return sums.column * factor + sums.row / factor < 0.95 * (sums.column + sums.row) ? factor : 1.0;
}

}  // namespace

void balance(std::vector<double>& matrix, int size) {
    const auto n = static_cast<std::size_t>(size);
    bool changed = true;
    for (int sweep = 0; sweep < 50 && changed; ++sweep) {
        changed = false;
        for (std::size_t index = 0; index < n; ++index) {
            const double factor = balancing_factor(lengths(matrix, n, index));
            if (factor == 1.0) continue;
            changed = true;
            for (std::size_t other = 0; other < n; ++other) matrix[index * n + other] *= factor;
            for (std::size_t other = 0; other < n; ++other) matrix[other * n + index] /= factor;
        }
    }
}

void sort_by_decay(Eigenvalues& values) {
    std::sort(values.begin(), values.end(),
              [](const auto& a, const auto& b) { return a.real() != b.real() ? a.real() < b.real() : a.imag() < b.imag(); });
}

Eigenvalues dense_eigenvalues(const double* matrix, int size) {
    const Eigen::EigenSolver<Eigen::MatrixXd> solver(Eigen::Map<const Eigen::MatrixXd>(matrix, size, size), false);
    if (solver.info() != Eigen::Success) return {};
    const auto& found = solver.eigenvalues();
    return {found.data(), found.data() + size};
}

Eigenvalues eigenvalues(std::vector<double> matrix, int size) {
    balance(matrix, size);
    Eigenvalues values = dense_eigenvalues(matrix.data(), size);
    if (values.empty() && size > 0) throw std::runtime_error("eigenvalues: the iteration does not converge");
    sort_by_decay(values);
    return values;
}

namespace {

using Eigen::Index;
using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// |y_m| / ‖y‖ of the Ritz vector: from its last component upwards, row by row of (H - λ) y = 0.
[[nodiscard]] double last_component(const RowMajor& hessenberg, std::complex<double> value) {
    const Index m = hessenberg.rows();
    Vector real = Vector::Zero(m), imaginary = Vector::Zero(m);
    real[m - 1] = 1.0;
    double last = 1.0;
    for (Index row = m - 1; row > 0; --row) {
        const auto entries = hessenberg.row(row).segment(row, m - row);
        const double re = entries.dot(real.tail(m - row)) - value.real() * real[row] + value.imag() * imaginary[row];
        const double im =
            value.imag() == 0.0 ? 0.0 : entries.dot(imaginary.tail(m - row)) - value.real() * imaginary[row] - value.imag() * real[row];
        real[row - 1] = -re / hessenberg(row, row - 1);
        imaginary[row - 1] = -im / hessenberg(row, row - 1);
        const double size = std::max(std::abs(real[row - 1]), std::abs(imaginary[row - 1]));
        if (size < 1e100) continue;
        real /= size, imaginary /= size, last /= size;
    }
    return last / std::sqrt(real.squaredNorm() + imaginary.squaredNorm());
}

[[nodiscard]] Eigen::VectorXd share_of_all(int size) {
    Eigen::VectorXd start(size);
    for (int k = 0; k < size; ++k)
        start[k] = model::portable_sin(1.0 + 12.9898 * static_cast<double>(k + 1) * static_cast<double>(k % 7 + 1));
    return start.normalized();
}

constexpr double nothing_lost = 0.7;  ///< share of a direction's length left by orthogonalisation, above which rounding has not grown

/// Eigenvalues of a Hessenberg matrix; empty: the iteration does not converge.
[[nodiscard]] std::vector<std::complex<double>> eigenvalues_of(const Eigen::MatrixXd& hessenberg) {
    Eigen::RealSchur<Eigen::MatrixXd> schur;
    schur.computeFromHessenberg(hessenberg, Eigen::MatrixXd(), false);
    if (schur.info() != Eigen::Success) return {};
    const Eigen::MatrixXd& t = schur.matrixT();
    std::vector<std::complex<double>> values;
    for (Eigen::Index k = 0; k < t.rows(); ++k) {
        if (k + 1 == t.rows() || t(k + 1, k) == 0.0) {
            values.emplace_back(t(k, k));
            continue;
        }
        const double half = 0.5 * (t(k, k) - t(k + 1, k + 1));  // a block of two is of a complex pair
        values.emplace_back(t(k + 1, k + 1) + half, std::sqrt(std::abs(half * half + t(k + 1, k) * t(k, k + 1))));
        ++k;
    }
    return values;
}

constexpr double nothing_new = 1e-14;  ///< share of the matrix below which a new direction is rounding

using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// A Krylov space with its Hessenberg matrix. Grows by one dimension at a time, orthogonalised twice; the same bits every time.
class KrylovSpace {
public:
    explicit KrylovSpace(int size);

    /// One more dimension; false: the product is not finite.
    [[nodiscard]] bool grow(const Sparse& matrix);
    [[nodiscard]] int dimension() const noexcept { return dimension_; }
    /// Invariant, or as large as the matrix: growing is over.
    [[nodiscard]] bool full() const noexcept { return invariant_ || dimension_ == size_; }

    /// Ritz values of imaginary part 0 or more [dimension, conjugates left out], in no order; exact in an invariant space.
    [[nodiscard]] std::vector<std::complex<double>> values() const;
    /// |matrix vector - value vector| of their Ritz vectors, without these: the last components, by Hyman's recurrence.
    [[nodiscard]] std::vector<double> residuals(const std::vector<std::complex<double>>& values) const;

private:
    const int size_;
    std::vector<double> basis_;       ///< orthonormal, column by column [size][size + 1]
    std::vector<double> hessenberg_;  ///< column by column [size + 1][size]
    int dimension_ = 0;
    bool invariant_ = false;
};

KrylovSpace::KrylovSpace(int size)
    : size_(size),
      basis_(static_cast<std::size_t>(size) * static_cast<std::size_t>(size_ + 1)),
      hessenberg_(static_cast<std::size_t>(size_ + 1) * static_cast<std::size_t>(size_)) {
    Eigen::Map<Eigen::VectorXd>(basis_.data(), size) = share_of_all(size);
}

bool KrylovSpace::grow(const Sparse& matrix) {
    Eigen::Map<Eigen::MatrixXd> basis(basis_.data(), size_, size_ + 1);
    Eigen::Map<Eigen::MatrixXd> hessenberg(hessenberg_.data(), size_ + 1, size_);
    Eigen::VectorXd next = matrix * basis.col(dimension_);
    if (!next.allFinite()) return false;
    const double length = next.norm();
    for (int pass = 0; pass < 2 && (pass == 0 || next.norm() < nothing_lost * length); ++pass) {  // twice is enough
        const Eigen::VectorXd shares = basis.leftCols(dimension_ + 1).transpose() * next;
        next -= basis.leftCols(dimension_ + 1) * shares;
        hessenberg.col(dimension_).head(dimension_ + 1) += shares;
    }
    const double rest = next.norm();
    hessenberg(dimension_ + 1, dimension_) = rest;
    ++dimension_;
    invariant_ = !(rest > nothing_new * hessenberg.topLeftCorner(dimension_, dimension_).norm());
    if (!invariant_) basis.col(dimension_) = next / rest;
    return true;
}

std::vector<std::complex<double>> KrylovSpace::values() const {
    const Eigen::Map<const Eigen::MatrixXd> hessenberg(hessenberg_.data(), size_ + 1, size_);
    return eigenvalues_of(hessenberg.topLeftCorner(dimension_, dimension_));
}

std::vector<double> KrylovSpace::residuals(const std::vector<std::complex<double>>& values) const {
    const Eigen::Map<const Matrix> hessenberg(hessenberg_.data(), size_ + 1, size_);
    const RowMajor rows = hessenberg.topLeftCorner(dimension_, dimension_);
    std::vector<double> all;
    for (const std::complex<double>& value : values)
        all.push_back(full() ? 0.0 : hessenberg(dimension_, dimension_ - 1) * last_component(rows, value));
    return all;
}

/// Eigenvalues left of the border, and the pair that oscillates fastest; of those with an imaginary part of 0 or more.
[[nodiscard]] Eigenvalues selected(Eigenvalues values, double left_of) {
    const auto fastest = std::ranges::max_element(values, {}, [](const auto& value) { return value.imag(); });
    const std::complex<double> pair = *fastest;
    std::erase_if(values, [&](const auto& value) { return value.real() >= left_of && value != pair; });
    return values;
}

}  // namespace

ExtremalEigenvalues extremal_eigenvalues(std::vector<double> matrix, int size, const ExtremalOptions& options) {
    balance(matrix, size);
    const Sparse sparse = Eigen::Map<const Matrix>(matrix.data(), size, size).sparseView();
    KrylovSpace space(size);
    ExtremalEigenvalues result;
    for (double requested = options.first_dimension;; requested *= 1.3) {
        while (space.dimension() < requested && !space.full() && space.grow(sparse)) {}
        const Eigenvalues halves = selected(space.values(), options.left_of);
        const std::vector<double> residuals = space.residuals(halves);
        result = {{}, 0.0, space.dimension()};
        int settled = 0;
        for (std::size_t k = 0; k < halves.size(); ++k) {
            const int count = halves[k].imag() > 0.0 ? 2 : 1;
            const double residual = residuals[k] == 0.0 ? 0.0 : residuals[k] / std::abs(halves[k]);
            result.values.push_back(halves[k]);
            if (count == 2) result.values.push_back(std::conj(halves[k]));
            settled += residual <= options.tolerance ? count : 0;
            result.residual = std::max(result.residual, residual);
        }
        const int asked = static_cast<int>(result.values.size());
        if (options.progress) options.progress(space.dimension(), settled, asked);
        if (!space.full() && settled < asked) continue;
        sort_by_decay(result.values);
        return result;
    }
}

}  // namespace cvtflow::bench
