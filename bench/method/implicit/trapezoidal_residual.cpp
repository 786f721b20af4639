#include "bench/method/implicit/trapezoidal.hpp"
#include "bench/method/product_names.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::bench {

namespace {

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

void TrapezoidalMethod::start_link(int link) noexcept {
    const int q = w_.layout().link_begin(link), v = q + size_;
    const double share = options_.start == NewtonStart::euler ? w_.step.h : 0.0;
    double* out = state(iterate_);
    for (int k = 0; k < size_; ++k) {
        const double before = state(0)[v + k];
        out[v + k] = before + share * w_.slopes[start_slope][v + k];
        out[q + k] = state(0)[q + k] + theta() * (before + out[v + k]);
    }
}

void TrapezoidalMethod::start_tail() noexcept {
    double* out = state(iterate_);
    const double share = options_.start == NewtonStart::euler ? w_.step.h : 0.0;
    std::copy(state(0) + q_tail_, state(0) + w_.layout().size(), out + q_tail_);
    for (int k = q_tail_; k < q_tail_ + half_; ++k) {
        out[k + half_] += share * w_.slopes[start_slope][k + half_];
        out[k] += theta() * (state(0)[k + half_] + out[k + half_]);
    }
}

/// Residual of the trial, its energy, and the right-hand side of the next solve.
void TrapezoidalMethod::residual_of_link(int link) noexcept {
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
double TrapezoidalMethod::residual_of_tail() noexcept {
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

}  // namespace cvtflow::bench
