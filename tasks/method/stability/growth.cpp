#include "tasks/method/stability/growth.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "engine/linear/eigenvalues.hpp"

namespace cvtflow::tasks {

namespace {

constexpr Eigen::Index between_judgements = 10;

/// A direction that has a share of every eigenvector, the same every time.
[[nodiscard]] Eigen::VectorXd share_of_all(Eigen::Index size) {
    Eigen::VectorXd start(size);
    for (Eigen::Index k = 0; k < size; ++k)
        start[k] = std::sin(1.0 + 12.9898 * static_cast<double>(k + 1) * static_cast<double>(k % 7 + 1));
    return start.normalized();
}

/// A Krylov space with its Hessenberg matrix.
class GrowthSpace {
public:
    GrowthSpace(Eigen::Index size, Eigen::Index most, const std::vector<double>& start)
        : basis_(size, most + 1), hessenberg_(Eigen::MatrixXd::Zero(most + 1, most)), next_(size) {
        Eigen::VectorXd first = share_of_all(size);
        if (static_cast<Eigen::Index>(start.size()) == size) {
            const Eigen::Map<const Eigen::VectorXd> given(start.data(), size);
            if (given.norm() > 0.0) first = given;
        }
        basis_.col(0) = first.normalized();
    }

    /// One more dimension; false: the map could not be applied.
    [[nodiscard]] bool grow(const LinearMap& map) {
        if (!map(basis_.col(dimension_).data(), next_.data()) || !next_.allFinite()) return false;
        for (int pass = 0; pass < 2; ++pass) {  // twice is enough
            const Eigen::VectorXd shares = basis_.leftCols(dimension_ + 1).transpose() * next_;
            next_ -= basis_.leftCols(dimension_ + 1) * shares;
            hessenberg_.col(dimension_).head(dimension_ + 1) += shares;
        }
        const double rest = next_.norm();
        hessenberg_(dimension_ + 1, dimension_) = rest;
        ++dimension_;
        complete_ = !(rest > 1e-14 * hessenberg_.topLeftCorner(dimension_, dimension_).norm());
        if (!complete_) basis_.col(dimension_) = next_ / rest;
        return true;
    }
    [[nodiscard]] Eigen::Index dimension() const noexcept { return dimension_; }
    /// It is invariant: its eigenvalues are exact.
    [[nodiscard]] bool complete() const noexcept { return complete_; }

    /// Of positive imaginary part or real, so far from 1 at least.
    [[nodiscard]] std::complex<double> largest(double from_one) const {
        const Eigen::MatrixXd square = hessenberg_.topLeftCorner(dimension_, dimension_);
        std::complex<double> largest = 0.0;
        for (const std::complex<double>& value : engine::dense_eigenvalues(square.data(), static_cast<int>(dimension_))) {
            if (value.imag() >= 0.0 && std::abs(value - 1.0) >= from_one && std::abs(value) > std::abs(largest)) largest = value;
        }
        return largest;
    }
    /// Its eigenvector, by two steps of inverse iteration.
    [[nodiscard]] Eigen::VectorXcd vector_of(std::complex<double> value) const {
        Eigen::MatrixXcd shifted = hessenberg_.topLeftCorner(dimension_, dimension_).cast<std::complex<double>>();
        shifted.diagonal().array() -= value * (1.0 + 1e-10);
        const Eigen::PartialPivLU<Eigen::MatrixXcd> solver(shifted);
        Eigen::VectorXcd x = Eigen::VectorXcd::Ones(dimension_);
        for (int step = 0; step < 2; ++step) x = solver.solve(x.normalized()).eval();
        return basis_.leftCols(dimension_) * x.normalized();
    }

private:
    Eigen::MatrixXd basis_, hessenberg_;
    Eigen::VectorXd next_;
    Eigen::Index dimension_ = 0;
    bool complete_ = false;
};

}  // namespace

Growth fastest_growth(int size, const LinearMap& map, const std::vector<double>& start, const GrowthSettings& settings) {
    GrowthSpace space(size, std::min(settings.most, size), start);
    Growth growth;
    double before = 0.0;
    for (bool settled = false; !settled && !space.complete() && space.dimension() < std::min(settings.most, size);) {
        ++growth.applications;
        if (!space.grow(map)) return {std::numeric_limits<double>::infinity(), {}, {}, {}, growth.applications};
        if (space.dimension() % between_judgements != 0) continue;
        const double now = std::abs(space.largest(settings.from_one));
        settled = std::abs(now - before) < settings.settled * now;
        before = now;
    }
    growth.multiplier = space.largest(settings.from_one);
    growth.factor = std::abs(growth.multiplier);
    const Eigen::VectorXcd vector = space.vector_of(growth.multiplier);
    for (Eigen::Index k = 0; k < vector.size(); ++k) {
        growth.real.push_back(vector[k].real());
        growth.imaginary.push_back(vector[k].imag());
    }
    return growth;
}

}  // namespace cvtflow::tasks
