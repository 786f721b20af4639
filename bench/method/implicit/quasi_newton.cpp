/// The trapezoidal rule's quasi-Newton variants: what becomes of the matrix between two iterations.

#include <cmath>

#include "bench/method/implicit/trapezoidal.hpp"
#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

namespace {

[[nodiscard]] double square(const double* x, int size) noexcept {
    double sum = 0.0;
    for (int k = 0; k < size; ++k) sum += x[k] * x[k];
    return sum;
}

}  // namespace

/// The solve has left B_0⁻¹(-r⁺): the update of the last step comes in, then the direction.
void TrapezoidalMethod::broyden_direction() noexcept {
    double* x = solution_.data();
    broyden_.apply(x);
    if (direction_) {
        const int known = broyden_.count();
        for (std::size_t k = 0; k < step_.size(); ++k) step_[k] -= x[k];  // w = B⁻¹ (r⁺ - r)
        broyden_.add(change_.data(), step_.data());
        broyden_.apply(x, known);
    }
    finish(0, w_.layout().links);
}

/// Squares of the change over what each row sees.
int TrapezoidalMethod::begin_update() noexcept {
    const ContactMap contacts{w_.tips.phases.data(), w_.links.loads.data()};
    squares_[0] = squares_[1] = 0.0;
    for (int link = 0; link < w_.layout().links; ++link) {
        if (const auto shaft = contacts.shaft(link)) squares_[*shaft] += square(velocities(change_, link), size_);
    }
    squares_[2] = square(border(change_), border_size_);
    return update_cycle;
}

/// B_i += e_i s_(i)ᵀ/|s_(i)|² on the rows of these links, e = r⁺ - (1 - λ) r, s_(i) the change restricted to the pattern of row i.
/// B = I - θ D - θ² K: the update is entered in D.
void TrapezoidalMethod::update(int segment) noexcept {
    const model::ChainLayout& at = w_.layout();
    const ContactMap contacts{w_.tips.phases.data(), w_.links.loads.data()};
    for (int link = w_.partition[segment].first; link < w_.partition[segment].last; ++link) {
        const auto shaft = contacts.shaft(link);
        const int near[3] = {at.previous(link), link, at.next(link)};
        double seen = 0.0;
        for (const int other : near) seen += square(velocities(change_, other), size_);
        if (shaft) {
            for (const int k : matrix_.seen(*shaft)) seen += border(change_)[k] * border(change_)[k];
        }
        if (!(seen > 0.0)) continue;
        const double* r = velocities(residual_, link);
        const double* before = velocities(residual_before_, link);
        for (int row = 0; row < size_; ++row) {
            const double factor = (r[row] - (1.0 - lambda_) * before[row]) / (seen * theta());
            for (int n = 0; n < 3; ++n) {
                double* d = jacobian_.link(link, static_cast<bench::Near>(n), bench::With::velocity) + row * size_;
                for (int k = 0; k < size_; ++k) d[k] -= factor * velocities(change_, near[n])[k];
            }
            if (!shaft) continue;
            for (const int k : matrix_.seen(*shaft))
                jacobian_.columns(link, bench::With::velocity)[row * border_size_ + k] -= factor * border(change_)[k];
        }
        if (shaft) update_border_rows(link, *shaft);
    }
}

double TrapezoidalMethod::border_factor(int row, double seen) noexcept {
    const double error = border(residual_)[row] - (1.0 - lambda_) * border(residual_before_)[row];
    return seen > 0.0 ? error / (seen * theta()) : 0.0;
}

/// Rows of the pulleys on one link that touches.
void TrapezoidalMethod::update_border_rows(int link, int shaft) noexcept {
    for (const int row : matrix_.seen(shaft)) {
        const double factor = border_factor(row, squares_[shaft] + squares_[2]);
        double* d = jacobian_.rows(link, bench::With::velocity) + row * size_;
        for (int k = 0; k < size_; ++k) d[k] -= factor * velocities(change_, link)[k];
    }
}

/// Rows of the pulleys on themselves; after all links.
void TrapezoidalMethod::update_corner() noexcept {
    for (int row = 0; row < border_size_; ++row) {
        double seen = squares_[2];
        for (int shaft = 0; shaft < 2; ++shaft) {
            for (const int k : matrix_.seen(shaft)) seen += k == row ? squares_[shaft] : 0.0;
        }
        const double factor = border_factor(row, seen);
        double* d = jacobian_.corner(bench::With::velocity) + row * border_size_;
        for (int k = 0; k < border_size_; ++k) d[k] -= factor * border(change_)[k];
    }
}

}  // namespace cvtflow::bench
