#include "bench/method/family/fitted.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>
#include <string>

#include "bench/method/family/families.hpp"

namespace cvtflow::bench {

namespace {

int basis_slope_slot(int j) { return j == 0 ? 0 : 1 + (j - 1) % 2; }

}  // namespace

ChebyshevBasis::ChebyshevBasis(int stages, double length)
    : stages_(stages),
      w0_(1.0 + rkc_damping / (static_cast<double>(stages) * stages)),
      w1_((1.0 + w0_) / length),
      t_{{1.0, w0_}, {0.0, 1.0}, {0.0, 0.0}, {0.0, 0.0}} {
    for (std::size_t j = 2; j <= static_cast<std::size_t>(stages); ++j) {
        for (std::size_t p = 0; p < 4; ++p) {
            const double lower = p == 0 ? 0.0 : 2.0 * static_cast<double>(p) * t_[p - 1][j - 1];
            t_[p].push_back(2.0 * w0_ * t_[p][j - 1] + lower - t_[p][j - 2]);
        }
    }
}

/// b_j = T_j'' / T_j'^2; b_0 = b_1 = b_2.
double ChebyshevBasis::b(int j) const noexcept {
    const auto i = static_cast<std::size_t>(j < 2 ? 2 : j);
    return t_[2][i] / (t_[1][i] * t_[1][i]);
}

void ChebyshevBasis::evaluate(std::complex<double> z, std::span<std::complex<double>> values) const noexcept {
    const std::complex<double> x = w0_ + w1_ * z;
    std::complex<double> before = 1.0, now = x;
    values[0] = 1.0;
    for (int j = 1; j <= stages_; ++j) {
        const auto i = static_cast<std::size_t>(j);
        values[i] = 1.0 + b(j) * (now - t_[0][i]);
        const std::complex<double> next = 2.0 * x * now - before;
        before = now;
        now = next;
    }
}

double ChebyshevBasis::derivative(int j, int p) const noexcept {
    if (p == 0) return 1.0;
    double power = b(j);
    for (int k = 0; k < p; ++k) power *= w1_;
    return power * t_[p][static_cast<std::size_t>(j)];
}

/// Y_j from Y_0, Y_{j-1}, Y_{j-2} and their slopes; all stages stay in separate slots until the end.
Stage ChebyshevBasis::row(int j) const {
    if (j == 1) return {{{0, 1.0}}, {{0, b(1) * w1_}}, 1, basis_slope_slot(1)};
    const double mu = 2.0 * b(j) * w0_ / b(j - 1), nu = -b(j) / b(j - 2);
    const double mu_slope = 2.0 * b(j) * w1_ / b(j - 1);
    const double a = 1.0 - b(j - 1) * t_[0][static_cast<std::size_t>(j - 1)];
    Stage stage{{}, {{0, -a * mu_slope}, {basis_slope_slot(j - 1), mu_slope}}, j, basis_slope_slot(j)};
    if (j == 2) {
        stage.states = {{0, 1.0 - mu}, {1, mu}};
    } else {
        stage.states = {{0, 1.0 - mu - nu}, {j - 1, mu}, {j - 2, nu}};
    }
    return stage;
}

StagePlan ChebyshevBasis::plan(std::span<const double> alpha) const {
    StagePlan plan{"fitted",
                   "fitted to a spectrum, on a Chebyshev recurrence",
                   "weights by Lawson's iteration",
                   stages_ + 1,
                   3,
                   {{{{0, 1.0}}, {}, -1, 0}},
                   {},
                   {}};
    for (int j = 1; j < stages_; ++j) plan.stages.push_back(row(j));
    // The highest stage is never evaluated; it is written out in the sum.
    const Stage highest = row(stages_);
    const double share = alpha[static_cast<std::size_t>(stages_)];
    std::vector<double> factors(alpha.begin(), alpha.end() - 1);
    for (const Term& term : highest.states) factors[static_cast<std::size_t>(term.slot)] += share * term.factor;
    factors[0] = 1.0;
    for (std::size_t j = 1; j < factors.size(); ++j) factors[0] -= factors[j];
    Stage end{{}, highest.slopes, stages_, basis_slope_slot(stages_)};
    for (Term& term : end.slopes) term.factor *= share;
    for (std::size_t j = 0; j < factors.size(); ++j) end.states.push_back({static_cast<int>(j), factors[j]});
    plan.stages.push_back(end);
    plan.result = {{{stages_, 1.0}}, {}};
    plan.error = Combination{{{0, 0.8}, {stages_, -0.8}}, {{0, 0.4}, {basis_slope_slot(stages_), 0.4}}};
    return plan;
}

namespace {

using Complex = std::complex<double>;

/// |R(z)| ≤ bound is required.
struct Point {
    Complex z;
    double bound;
};

constexpr double inner = 0.3;  ///< |z| below which consistency alone decides
constexpr double knee = 4.0;   ///< real z beyond which the ripple applies
constexpr int max_iterations = 60;
constexpr double slimmest = 10.0;  ///< real over imaginary extent of the basis: off a short real interval its polynomials grow too fast
constexpr int max_useless_iterations = 8;  ///< iterations after which
constexpr double hopeless = 1.5;           ///< a largest residual beyond this will not come down to 1
constexpr double margin = 5e-5;
constexpr double ridge = 1e-2;  ///< keeps the weights small: they multiply rounding and kinks
constexpr double min_weight = 1e-14;

double real_bound(const FitRequest& request, double z) { return z < -knee ? request.ripple : 1.0; }

void add_real_axis(std::vector<Point>& points, const FitRequest& request) {
    const int count = 40 + 8 * static_cast<int>(std::ceil(std::sqrt(request.real)));
    for (int i = 0; i <= count; ++i) {
        const double z = 0.51 * request.real * (static_cast<double>(std::cos(std::numbers::pi_v<long double> * i / count)) - 1.0);
        if (z < -inner) points.push_back({z, real_bound(request, z)});
    }
    points.push_back({-knee * 1.0001, request.ripple});
}

/// Rays from the least damping ratio to the real axis.
void add_sector(std::vector<Point>& points, const FitRequest& request) {
    constexpr int rays = 20;
    const int radii = 12 + 4 * static_cast<int>(std::ceil(request.imaginary));
    const double widest =
        static_cast<double>(std::acos(static_cast<long double>(request.damping_ratio)));  // that of doubles differs between processors
    for (int ray = 0; ray < rays; ++ray) {
        const double angle = widest * (1.0 - static_cast<double>(ray * ray) / (rays * rays));
        for (int i = 1; i <= radii; ++i) {
            const double radius = request.imaginary * i / radii;
            if (radius > inner) points.push_back({std::polar(radius, std::numbers::pi - angle), 1.0});
        }
    }
}

std::vector<Point> region(const FitRequest& request) {
    std::vector<Point> points;
    add_real_axis(points, request);
    add_sector(points, request);
    return points;
}

/// max |R|/bound and each point's share of it.
struct Residuals {
    Eigen::VectorXd values;  ///< [points]
    double largest;
};

/// Least squares for the weights alpha: rows of points (real and imaginary parts), with the order conditions met exactly.
class LawsonFit {
public:
    LawsonFit(const ChebyshevBasis& basis, const std::vector<Point>& points, int order)
        : rows_(static_cast<Eigen::Index>(2 * points.size()), basis.stages() + 1),
          weights_(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(points.size()))) {
        std::vector<Complex> values(static_cast<std::size_t>(basis.stages()) + 1);
        for (std::size_t i = 0; i < points.size(); ++i) {
            basis.evaluate(points[i].z, values);
            const auto row = static_cast<Eigen::Index>(2 * i);
            for (std::size_t j = 0; j < values.size(); ++j) {
                rows_(row, static_cast<Eigen::Index>(j)) = values[j].real() / points[i].bound;
                rows_(row + 1, static_cast<Eigen::Index>(j)) = values[j].imag() / points[i].bound;
            }
        }
        constrain(basis, order);
    }

    /// Iterates until all points are within their bounds. @return iterations, or nothing if that does not come about
    std::optional<int> run() {
        for (int iteration = 0; iteration <= max_iterations; ++iteration) {
            solve();
            const Residuals residuals = measure();
            largest_ = residuals.largest;
            if (largest_ <= 1.0 - margin) return iteration;
            if (iteration >= max_useless_iterations && largest_ > hopeless) return {};
            weights_ = (weights_.array() * residuals.values.array() / residuals.largest).matrix();
            weights_ = (weights_ / weights_.maxCoeff()).cwiseMax(min_weight);
        }
        return {};
    }

    [[nodiscard]] const Eigen::VectorXd& alpha() const noexcept { return alpha_; }
    [[nodiscard]] double largest() const noexcept { return largest_; }

private:
    /// Order conditions: particular solution and null space.
    void constrain(const ChebyshevBasis& basis, int order) {
        const Eigen::Index columns = rows_.cols(), conditions = order + 1;
        Eigen::MatrixXd matrix(conditions, columns);
        for (Eigen::Index j = 0; j < columns; ++j) {
            for (int p = 0; p <= order; ++p) matrix(p, j) = basis.derivative(static_cast<int>(j), p);
        }
        const Eigen::HouseholderQR<Eigen::MatrixXd> qr(matrix.transpose());
        const Eigen::MatrixXd q = qr.householderQ();
        const Eigen::MatrixXd r = qr.matrixQR().topLeftCorner(conditions, conditions).triangularView<Eigen::Upper>();
        Eigen::VectorXd shares = Eigen::VectorXd::Ones(conditions);
        r.transpose().triangularView<Eigen::Lower>().solveInPlace(shares);
        particular_.noalias() = q.leftCols(conditions) * shares;
        free_ = q.rightCols(columns - conditions);
        reduced_ = rows_ * free_;
        offset_ = rows_ * particular_;
    }

    void solve() {
        Eigen::VectorXd twice(rows_.rows());
        for (Eigen::Index i = 0; i < weights_.size(); ++i) twice(2 * i) = twice(2 * i + 1) = weights_(i);
        const Eigen::MatrixXd weighted = twice.asDiagonal() * reduced_;
        Eigen::MatrixXd normal = reduced_.transpose() * weighted;
        normal.diagonal().array() += ridge * normal.trace() / static_cast<double>(normal.rows());
        alpha_ = particular_ - free_ * normal.ldlt().solve(weighted.transpose() * offset_);
    }

    [[nodiscard]] Residuals measure() const {
        const Eigen::VectorXd parts = rows_ * alpha_;
        Residuals residuals{Eigen::VectorXd(weights_.size()), 0.0};
        for (Eigen::Index i = 0; i < weights_.size(); ++i)
            residuals.values(i) = std::sqrt(parts(2 * i) * parts(2 * i) + parts(2 * i + 1) * parts(2 * i + 1));
        residuals.largest = residuals.values.maxCoeff();
        return residuals;
    }

    Eigen::MatrixXd rows_, free_, reduced_;
    Eigen::VectorXd weights_, particular_, offset_, alpha_;
    double largest_ = 0.0;
};

bool request_within_limits(const FitRequest& r) {
    return r.real >= min_fitted_real && r.real <= max_fitted_real && r.imaginary >= 0.0 && r.imaginary <= max_fitted_imaginary &&
           (r.order == 2 || r.order == 3) && r.ripple > 0.0 && r.ripple <= 1.0 && r.damping_ratio >= 0.0 && r.damping_ratio <= 1.0;
}

void require_limits(const FitRequest& request) {
    if (!request_within_limits(request))
        throw std::invalid_argument(
            "a fitted method has a real interval of 5 to 8000, an imaginary one up to 50, order 2 or 3 and a ripple of up to 1");
}

std::optional<FittedMethod> fit_points(const FitRequest& request, const std::vector<Point>& points, int stages) {
    const ChebyshevBasis basis(stages, 1.03 * std::max(request.real, slimmest * request.imaginary));
    LawsonFit least_squares(basis, points, request.order);
    const std::optional<int> iterations = least_squares.run();
    if (!iterations) return {};
    const std::vector<double> alpha(least_squares.alpha().data(), least_squares.alpha().data() + least_squares.alpha().size());
    return FittedMethod{basis.plan(alpha), *iterations, least_squares.largest()};
}

/// Increases the stages until a fit is found, then halves the interval: if s stages suffice, so do s + 1.
std::optional<FittedMethod> min_stages(const FitRequest& request) {
    const std::vector<Point> points = region(request);
    int too_few = std::max(min_fitted_stages, static_cast<int>(std::sqrt(request.real / 0.85))) - 1;
    int enough = too_few + 1;
    std::optional<FittedMethod> found = fit_points(request, points, enough);
    while (!found) {
        if (enough == max_fitted_stages) return {};
        too_few = enough;
        enough = std::min(max_fitted_stages, enough + enough / 3 + 1);
        found = fit_points(request, points, enough);
    }
    while (enough - too_few > 1) {
        const int middle = (enough + too_few) / 2;
        auto better = fit_points(request, points, middle);
        (better ? enough : too_few) = middle;
        if (better) found = std::move(better);
    }
    return found;
}

}  // namespace

std::optional<FittedMethod> fit(const FitRequest& request, int stages) {
    require_limits(request);
    if (stages < min_fitted_stages || stages > max_fitted_stages) throw std::invalid_argument("a fitted method has 4 to 150 stages");
    return fit_points(request, region(request), stages);
}

std::optional<FittedMethod> fit(const FitRequest& request) {
    require_limits(request);
    return min_stages(request);
}

std::optional<StagePlan> fitted_by_name(std::string_view name) {
    const auto values = name_values(name, "fitted", "lwspr");
    if (!values || !values->contains('l') || !values->contains('w')) return {};
    const auto value = [&](char key, double otherwise) { return values->contains(key) ? values->at(key) : otherwise; };
    const FitRequest usual;
    const double order = value('p', usual.order), stages = value('s', 0.0);
    const FitRequest request{values->at('l'), values->at('w'), static_cast<int>(order), value('r', usual.ripple), usual.damping_ratio};
    const bool whole = order == request.order && stages == std::floor(stages) && std::abs(stages) <= max_fitted_stages;
    if (!whole || !request_within_limits(request)) return {};
    if (values->contains('s') && stages < min_fitted_stages) return {};
    std::optional<FittedMethod> fitted = values->contains('s') ? fit(request, static_cast<int>(stages)) : fit(request);
    if (!fitted) return {};
    fitted->plan.name = name;
    return std::move(fitted->plan);
}

}  // namespace cvtflow::bench
