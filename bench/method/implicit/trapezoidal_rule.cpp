#include "bench/method/implicit/trapezoidal_rule.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "model/start/start_state.hpp"

namespace cvtflow::bench {

namespace {

constexpr int increment_slot = 2;

/// 2 x kinetic energy of a link with these velocities [J].
[[nodiscard]] double link_energy(const model::ChainModel& chain, const double* v) noexcept {
    const model::LinkInertia& inertia = chain.inertia();
    const auto form = [](const double* matrix, int size, const double* x) {
        double sum = 0.0;
        for (int row = 0; row < size; ++row) {
            for (int column = 0; column < size; ++column) sum += matrix[row * size + column] * x[row] * x[column];
        }
        return sum;
    };
    const int lateral = 2 * chain.layout().lateral();
    return form(inertia.lateral_matrix.data(), lateral, v) + form(inertia.lateral_matrix.data(), lateral, v + lateral) +
           form(inertia.axial_matrix.data(), 4, v + 2 * lateral);
}

}  // namespace

TrapezoidalRule::TrapezoidalRule(Workspace& workspace, NewtonStart start)
    : ImplicitMethod(workspace),
      residual_(right_side_),
      start_(start),
      link_mass_(model::link_mass(workspace.parameters)),
      energies_(static_cast<std::size_t>(w_.layout().links)) {}

/// Whether the slope at the start is known: the step is taken again, shorter, or begins where the last one has ended.
bool TrapezoidalRule::knows_start_slope() noexcept {
    const bool again = start_slope_ && w_.step.time == time_of_start_;
    time_of_start_ = w_.step.time;
    if (again) return true;
    if (!std::exchange(end_slope_, false)) return false;
    std::swap(w_.slopes[trial_slope], w_.slopes[start_slope]);
    return start_slope_ = true;
}

int TrapezoidalRule::evaluate_start() noexcept {
    terms_[0] = {0, 1.0};
    return evaluate({terms_, 1}, 0.0, start_slope);
}

/// Prepare cycle of the start of the iteration: v⁺ = v, or v + h a. The slope at the step's start has been evaluated.
int TrapezoidalRule::predict() noexcept {
    start_slope_ = predicting_ = true;
    end_slope_ = false;
    return prepare_cycle;
}

void TrapezoidalRule::prepare(int segment) noexcept {
    for (int link = w_.partition[segment].first; link < w_.partition[segment].last; ++link) {
        if (predicting_) {
            start_link(link);
        } else {
            residual_of_link(link);
        }
    }
}

void TrapezoidalRule::start_link(int link) noexcept {
    const int q = w_.layout().link_begin(link), v = q + size_;
    const double share = start_ == NewtonStart::euler ? w_.step.h : 0.0;
    double* out = state(iterate_);
    for (int k = 0; k < size_; ++k) {
        const double before = state(0)[v + k];
        out[v + k] = before + share * w_.slopes[start_slope][v + k];
        out[q + k] = state(0)[q + k] + theta() * (before + out[v + k]);
    }
}

void TrapezoidalRule::start_tail() noexcept {
    double* out = state(iterate_);
    const double share = start_ == NewtonStart::euler ? w_.step.h : 0.0;
    std::copy(state(0) + q_tail_, state(0) + w_.layout().size(), out + q_tail_);
    for (int k = q_tail_; k < q_tail_ + half_; ++k) {
        out[k + half_] += share * w_.slopes[start_slope][k + half_];
        out[k] += theta() * (state(0)[k + half_] + out[k + half_]);
    }
    predicting_ = false;
}

/// Trial = iterate + λ increment, into the trial's slot.
int TrapezoidalRule::evaluate_trial(double lambda) noexcept {
    terms_[0] = {iterate_, 1.0};
    terms_[1] = {increment_slot, lambda};
    const std::span<const engine::Term> terms(terms_, lambda == 0.0 ? 1 : 2);
    return evaluate(terms, 1.0, trial_slope, trial_);
}

/// Residual of the trial, its energy, and the right-hand side of the next solve.
void TrapezoidalRule::residual_of_link(int link) noexcept {
    const int v = w_.layout().link_begin(link) + size_;
    double* r = velocities(residual_, link);
    double* f = velocities(right_side_, link);
    for (int k = 0; k < size_; ++k) {
        r[k] = state(trial_)[v + k] - state(0)[v + k] - theta() * (w_.slopes[start_slope][v + k] + w_.slopes[trial_slope][v + k]);
        f[k] = -r[k];
    }
    energies_[static_cast<std::size_t>(link)] = link_energy(w_.variator.chain(), r);
}

/// Residual of the unknowns behind the links; the integral has no energy. @return its energy
double TrapezoidalRule::residual_of_tail() noexcept {
    double energy = 0.0;
    for (int k = 0; k < border_size_; ++k) {
        const int v = q_tail_ + half_ + k;
        const double r = state(trial_)[v] - state(0)[v] - theta() * (w_.slopes[start_slope][v] + w_.slopes[trial_slope][v]);
        border(residual_)[k] = r;
        border(right_side_)[k] = -r;
        if (k < half_) energy += w_.variator.pulleys().inertia(k) * r * r;
    }
    return energy;
}

double TrapezoidalRule::residual_norm() noexcept {
    double energy = residual_of_tail();
    for (const double part : energies_) energy += part;
    return std::isfinite(energy) ? std::sqrt(energy / link_mass_) : HUGE_VAL;
}

void TrapezoidalRule::finish(int first, int last) noexcept {
    for (int link = first; link < last; ++link) {
        double* q = state(increment_slot) + w_.layout().link_begin(link);
        const double* x = velocities(solution_, link);
        for (int k = 0; k < size_; ++k) {
            q[k] = theta() * x[k];
            q[size_ + k] = x[k];
        }
    }
}

void TrapezoidalRule::finish_tail() noexcept {
    double* out = state(increment_slot) + q_tail_;
    std::fill(out, out + w_.tail_size(), 0.0);
    for (int k = 0; k < border_size_; ++k) {
        out[half_ + k] = border(solution_)[k];
        if (k < half_) out[k] = theta() * border(solution_)[k];
    }
}

/// The iterate is the result of the step; its ledger is a quadrature.
void TrapezoidalRule::take_iterate() noexcept {
    const int ledger = w_.layout().ledger_begin();
    for (int k = ledger; k < w_.layout().size(); ++k)
        state(iterate_)[k] = state(0)[k] + theta() * (w_.slopes[start_slope][k] + w_.slopes[trial_slope][k]);
    terms_[0] = {iterate_, 1.0};
    w_.step.row = {{terms_, 1}, {}, -1, -1, 1.0};
}

}  // namespace cvtflow::bench
