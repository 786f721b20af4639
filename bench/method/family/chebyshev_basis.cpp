#include "bench/method/family/chebyshev_basis.hpp"

#include <cstddef>

#include "bench/method/family/rkc.hpp"

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

/// Y_j from Y_0, Y_{j-1}, Y_{j-2} and their slopes; all stages stay in slots of their own until the end.
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

}  // namespace cvtflow::bench
