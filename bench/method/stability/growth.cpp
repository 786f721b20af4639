#include "bench/method/stability/growth.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "model/basis/portable_math.hpp"

namespace cvtflow::bench {

namespace {

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

}  // namespace

KrylovSpace::KrylovSpace(int size, int most, const std::vector<double>& start)
    : size_(size),
      most_(std::min(size, most)),
      basis_(static_cast<std::size_t>(size) * static_cast<std::size_t>(most_ + 1)),
      hessenberg_(static_cast<std::size_t>(most_ + 1) * static_cast<std::size_t>(most_)) {
    Eigen::Map<Eigen::VectorXd> first(basis_.data(), size);
    first = share_of_all(size);
    if (static_cast<int>(start.size()) != size) return;
    const Eigen::Map<const Eigen::VectorXd> given(start.data(), size);
    if (given.norm() > 0.0) first = given.normalized();
}

bool KrylovSpace::grow(const LinearMap& map) {
    Eigen::Map<Eigen::MatrixXd> basis(basis_.data(), size_, most_ + 1);
    Eigen::Map<Eigen::MatrixXd> hessenberg(hessenberg_.data(), most_ + 1, most_);
    Eigen::VectorXd next(size_);
    if (!map(basis.col(dimension_).data(), next.data()) || !next.allFinite()) return false;
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
    const Eigen::Map<const Eigen::MatrixXd> hessenberg(hessenberg_.data(), most_ + 1, most_);
    return eigenvalues_of(hessenberg.topLeftCorner(dimension_, dimension_));
}

RitzVector KrylovSpace::vector_of(std::complex<double> value) const {
    const Eigen::Map<const Eigen::MatrixXd> basis(basis_.data(), size_, most_ + 1);
    const Eigen::Map<const Eigen::MatrixXd> hessenberg(hessenberg_.data(), most_ + 1, most_);
    Eigen::MatrixXcd shifted = hessenberg.topLeftCorner(dimension_, dimension_).cast<std::complex<double>>();
    shifted.diagonal().array() -= value * (1.0 + 1e-10);
    const Eigen::PartialPivLU<Eigen::MatrixXcd> solver(shifted);
    Eigen::VectorXcd x = Eigen::VectorXcd::Ones(dimension_);
    for (int step = 0; step < 2; ++step) x = solver.solve(x.normalized()).eval();
    x.normalize();
    const Eigen::VectorXcd vector = basis.leftCols(dimension_) * x;
    return {{vector.data(), vector.data() + vector.size()},
            invariant_ ? 0.0 : hessenberg(dimension_, dimension_ - 1) * std::abs(x[dimension_ - 1])};
}

namespace {

constexpr int first_judgement = 20;  // dimensions; then whenever they have doubled: eigenvalues of the Hessenberg matrix are expensive

/// Eigenvalues that count, the largest first.
[[nodiscard]] std::vector<std::complex<double>> candidates(const KrylovSpace& space, double from_one) {
    std::vector<std::complex<double>> values = space.values();
    std::erase_if(values, [&](const std::complex<double>& value) { return std::abs(value - 1.0) < from_one; });
    std::ranges::sort(values, std::ranges::greater{}, [](const std::complex<double>& value) { return std::abs(value); });
    return values;
}

void take(Growth& growth, const std::complex<double>& multiplier, const RitzVector& ritz) {
    growth.multiplier = multiplier;
    growth.factor = std::abs(multiplier);
    growth.uncertainty = ritz.residual;
    growth.real.clear();
    growth.imaginary.clear();
    for (const std::complex<double>& entry : ritz.vector) {
        growth.real.push_back(entry.real());
        growth.imaginary.push_back(entry.imag());
    }
}

/// The first one; another one that grows if more of its growth is certain.
void take_most_certain(Growth& growth, const KrylovSpace& space, const std::vector<std::complex<double>>& values) {
    for (const std::complex<double>& value : values) {
        if (&value != values.data() && std::abs(value) <= std::max(1.0, growth.certain())) break;
        Growth other;
        take(other, value, space.vector_of(value));
        if (&value != values.data() && other.certain() <= growth.certain()) continue;
        other.applications = growth.applications;
        growth = std::move(other);
    }
}

[[nodiscard]] Growth growth_from(int size, const LinearMap& map, const std::vector<double>& start, const GrowthSettings& settings) {
    KrylovSpace space(size, settings.most, start);
    Growth growth;
    double before = 0.0;
    int judge_at = first_judgement;
    for (bool settled = false; !settled && !space.full();) {
        ++growth.applications;
        if (!space.grow(map)) {
            growth.factor = std::numeric_limits<double>::infinity();
            return growth;
        }
        if (space.dimension() != judge_at) continue;
        judge_at *= 2;
        const std::vector<std::complex<double>> values = candidates(space, settings.from_one);
        const double now = values.empty() ? 0.0 : std::abs(values.front());
        settled = std::abs(now - before) < settings.settled * now;
        before = now;
    }
    take_most_certain(growth, space, candidates(space, settings.from_one));
    return growth;
}

}  // namespace

Growth fastest_growth(int size, const LinearMap& map, const std::vector<double>& start, const GrowthSettings& settings) {
    Growth growth = growth_from(size, map, start, settings);
    for (int k = 0; k < settings.restarts && growth.certain() < growth.factor; ++k) {
        const int applications = growth.applications;
        growth = growth_from(size, map, growth.real, settings);
        growth.applications += applications;
    }
    return growth;
}

}  // namespace cvtflow::bench
