#include "bench/method/analysis/eigenvalues.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "bench/method/product_names.hpp"

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

/// An orthonormal basis of the Krylov space and the matrix in this basis: M V = V H + β v e_mᵀ.
class KrylovBasis {
public:
    KrylovBasis(const std::vector<double>& matrix, int size) : matrix_(Eigen::Map<const Matrix>(matrix.data(), size, size).sparseView()) {
        std::mt19937_64 random(20);  // raw draws are the same everywhere, distributions are not
        Vector start(size);
        for (double& entry : start) entry = static_cast<double>(random() >> 11) * 0x1p-53 - 0.5;
        basis_.resize(size, 1);
        basis_.col(0) = start.normalized();
    }

    [[nodiscard]] int dimension() const noexcept { return dimension_; }
    [[nodiscard]] double beta() const noexcept { return beta_; }
    [[nodiscard]] auto projected() const { return projected_.topLeftCorner(dimension_, dimension_); }

    /// Adds dimensions up to `requested`, or until the space is invariant (beta() = 0).
    void grow(int requested) {
        basis_.conservativeResize(Eigen::NoChange, requested + 1);
        Matrix larger = Matrix::Zero(requested + 1, requested);
        if (dimension_ > 0) larger.topLeftCorner(dimension_ + 1, dimension_) = projected_.topLeftCorner(dimension_ + 1, dimension_);
        projected_ = std::move(larger);
        while (dimension_ < requested && (dimension_ == 0 || beta_ > 0.0)) extend();
    }

private:
    void extend() {
        const Index k = dimension_;
        const auto basis = basis_.leftCols(k + 1);
        Vector next = matrix_ * basis_.col(k);
        const double before = next.norm();
        for (int pass = 0; pass < 2; ++pass) {  // twice is enough
            const Vector shares = basis.transpose() * next;
            next.noalias() -= basis * shares;
            projected_.col(k).head(k + 1) += shares;
        }
        beta_ = next.norm();
        if (beta_ <= 1e-14 * before) beta_ = 0.0;
        projected_(k + 1, k) = beta_;
        if (beta_ > 0.0) basis_.col(k + 1) = next / beta_;
        ++dimension_;
    }

    const Eigen::SparseMatrix<double, Eigen::RowMajor> matrix_;
    Matrix basis_;      ///< [size, dimension + 1]
    Matrix projected_;  ///< H and the row of β below it
    int dimension_ = 0;
    double beta_ = 0.0;
};

Eigenvalues ritz_values(const Matrix& hessenberg) {
    Eigen::RealSchur<Matrix> schur(hessenberg.rows());
    schur.computeFromHessenberg(hessenberg, Matrix(), false);
    const Matrix& t = schur.matrixT();
    Eigenvalues values;
    for (Index k = 0; k < t.rows(); ++k) {
        if (k + 1 == t.rows() || t(k + 1, k) == 0.0) {
            values.emplace_back(t(k, k), 0.0);
            continue;
        }
        const double half = 0.5 * (t(k, k) + t(k + 1, k + 1)), difference = 0.5 * (t(k, k) - t(k + 1, k + 1));
        const double square = difference * difference + t(k, k + 1) * t(k + 1, k);
        const double imaginary = std::sqrt(std::abs(square));
        values.emplace_back(half, imaginary);
        values.emplace_back(half, -imaginary);
        ++k;
    }
    sort_by_decay(values);
    return values;
}

/// |y_m| / ‖y‖ of the Ritz vector: from its last component upwards, row by row of (H - λ) y = 0.
double last_component(const RowMajor& hessenberg, std::complex<double> value) {
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

/// Eigenvalues left of the border, and the pair that oscillates fastest.
Eigenvalues selected(const Eigenvalues& values, double left_of) {
    const auto fastest = std::max_element(values.begin(), values.end(),
                                          [](const auto& a, const auto& b) { return std::abs(a.imag()) < std::abs(b.imag()); });
    Eigenvalues chosen;
    for (const auto& value : values) {
        const bool pair = value.real() == fastest->real() && std::abs(value.imag()) == std::abs(fastest->imag());
        if (value.real() < left_of || pair) chosen.push_back(value);
    }
    return chosen;
}

}  // namespace

ExtremalEigenvalues extremal_eigenvalues(std::vector<double> matrix, int size, const ExtremalOptions& options) {
    balance(matrix, size);
    KrylovBasis space(matrix, size);
    ExtremalEigenvalues result;
    for (double requested = options.first_dimension;; requested *= 1.3) {
        space.grow(std::min(static_cast<int>(requested), size));
        const Matrix hessenberg = space.projected();
        const RowMajor rows = hessenberg;
        result.values = selected(ritz_values(hessenberg), options.left_of);
        result.dimension = space.dimension();
        result.residual = 0.0;
        const bool complete = space.dimension() == size || space.beta() == 0.0;
        int settled = 0;
        for (const auto& value : result.values) {
            const double residual = complete || std::abs(value) == 0.0 ? 0.0 : space.beta() * last_component(rows, value) / std::abs(value);
            settled += residual <= options.tolerance ? 1 : 0;
            result.residual = std::max(result.residual, residual);
        }
        const int asked = static_cast<int>(result.values.size());
        if (options.progress) options.progress(space.dimension(), settled, asked);
        if (complete || settled == asked) return result;
    }
}

}  // namespace cvtflow::bench
