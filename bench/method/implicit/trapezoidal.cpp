#include "bench/method/implicit/trapezoidal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "bench/method/product_names.hpp"
#include "model/start/start_state.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::bench {

std::string text(const NewtonStatistics& s) {
    const double steps = s.steps > 0 ? static_cast<double>(s.steps) : 1.0;
    std::string line = fmt::format("{:.2f} iterations per step (max {}), {} Jacobians, {} factorisations, {} halvings",
                                   static_cast<double>(s.iterations) / steps, s.most, s.jacobians, s.factorisations, s.backtracks);
    if (s.refreshed > 0) line += fmt::format("; {} of {} steps required a new Jacobian", s.refreshed, s.steps);
    if (s.unconverged > 0)
        line += fmt::format("; {} of {} steps did not converge and used the best iterate (residual up to {:.2g} m/s)", s.unconverged,
                            s.steps, s.worst);
    return line;
}

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

namespace {

/// Least share of a Newton step that is tried: with a matrix of this iterate, and with an older one.
constexpr double shortest = 1.0 / 256.0, shortest_with_old = 1.0 / 8.0;
/// Factor of the residual above which a matrix is given up, after some iterations: few with a matrix kept over steps, many with one of this
/// step.
constexpr double poor_contraction = 0.5;
constexpr int iterations_with_old = 3, iterations_with_new = 10;
constexpr int max_updates = 30;

}  // namespace

TrapezoidalMethod::TrapezoidalMethod(Workspace& workspace, const NewtonOptions& options)
    : TrapezoidalRule(workspace, options.start),
      options_(options),
      broyden_(matrix_.unknowns(), options.matrix == NewtonMatrix::broyden ? max_updates : 0),
      residual_before_(right_side_),
      step_(right_side_),
      change_(right_side_) {
    exact_ = options.exact;
    finish_in_tasks_ = options.matrix != NewtonMatrix::broyden;
}

void TrapezoidalMethod::restart() noexcept {
    phases_changed();  // discards the slopes
    has_jacobian_ = false;
    since_jacobian_ = 0;
    broyden_.clear();
}

void TrapezoidalMethod::visit(engine::Archive& archive) {
    bool keeps = keeps_over_steps(options_.matrix) && has_jacobian_;
    archive("knows_slope", end_slope_), archive("keeps_jacobian", keeps);
    archive("since_jacobian", since_jacobian_, 0, std::numeric_limits<int>::max());
    if (end_slope_) archive("slope", std::span(w_.slopes[trial_slope], static_cast<std::size_t>(w_.layout().size())));
    if (archive.reads()) has_jacobian_ = keeps;
    if (!keeps) return;
    broyden_.visit(archive);
    visit_factors(archive);
}

CycleSequence TrapezoidalMethod::step() {
    ++statistics_.steps;
    iterations_ = 0;
    refreshed_ = direction_ = renew_ = false;
    first_ = true;
    if (!knows_start_slope()) {
        co_yield evaluate_start();
        close_evaluation(w_);
    }
    co_yield predict();
    start_tail();
    for (lambda_ = 0.0;;) {
        co_yield evaluate_trial(lambda_);
        close_evaluation(w_);
        co_yield prepare_cycle;
        const double norm = residual_norm();
        if (!first_ && !falls(norm) && options_.backtracking) {
            if (!shorten()) co_return give_up();
            lambda_ = first_ ? 0.0 : 0.5 * lambda_;
            continue;
        }
        accept_trial(norm);
        if (end_slope_) co_return {};
        if (!std::isfinite(norm) || iterations_ >= options_.max_iterations) co_return give_up();
        const Matrix matrix = next_matrix();
        if (matrix == Matrix::new_jacobian) co_yield new_jacobian();
        if (matrix == Matrix::update) {
            co_yield begin_update();
            update_corner();
        }
        if (matrix != Matrix::stays) co_yield factorise(theta());
        if (matrix != Matrix::stays && !matrix_.sound()) co_return give_up();
        ++solves_;
        co_yield solve_cycle;
        finish_solve();
        lambda_ = 1.0;
    }
}

bool TrapezoidalMethod::falls(double norm) const noexcept { return norm <= (1.0 - 1e-4 * lambda_) * norm_ || norm <= options_.tolerance; }

/// The residual of the trial does not fall. @return whether a shorter part of the step is to be tried, or (first_) a new Jacobian at the
/// iterate, if the present one is not of it
bool TrapezoidalMethod::shorten() noexcept {
    ++statistics_.backtracks;
    if (lambda_ > (since_jacobian_ == 0 ? shortest : shortest_with_old)) return true;
    if (since_jacobian_ == 0) return false;
    return refreshed_ = renew_ = first_ = true;
}

/// The trial becomes the iterate; the last one, if its residual is small enough (end_slope_).
void TrapezoidalMethod::accept_trial(double norm) noexcept {
    std::swap(iterate_, trial_);
    if (!std::exchange(first_, false)) {
        ++iterations_;
        ++since_jacobian_;
        contraction_ = norm / norm_;
        for (std::size_t k = 0; k < change_.size(); ++k) change_[k] = lambda_ * step_[k];
    }
    norm_ = norm;
    end_slope_ = std::isfinite(norm) && norm <= options_.tolerance;
    if (end_slope_) finish_step();
}

/// Change of the matrix by the variant's rule.
TrapezoidalMethod::Matrix TrapezoidalMethod::next_matrix() noexcept {
    if (std::exchange(renew_, false)) return Matrix::new_jacobian;
    const bool by_rule =
        options_.matrix == NewtonMatrix::every_iteration || (options_.matrix == NewtonMatrix::once_per_step && iterations_ == 0);
    if (by_rule || !has_jacobian_) return Matrix::new_jacobian;
    const int iterations_to_show = keeps_over_steps(options_.matrix) ? iterations_with_old : iterations_with_new;
    const bool poor = since_jacobian_ > 0 && iterations_ >= iterations_to_show && contraction_ > poor_contraction;
    refreshed_ = refreshed_ || poor;
    if (poor || (options_.matrix == NewtonMatrix::broyden && broyden_.full())) return Matrix::new_jacobian;
    if (options_.matrix == NewtonMatrix::schubert && direction_) return Matrix::update;
    if (std::abs(theta_ - theta()) <= 1e-9 * theta()) return Matrix::stays;  // the grid of times rounds
    broyden_.clear();
    direction_ = false;
    return Matrix::factorise;
}

int TrapezoidalMethod::new_jacobian() noexcept {
    has_jacobian_ = true;
    direction_ = false;
    since_jacobian_ = 0;
    broyden_.clear();
    return take_jacobian(1.0, iterate_, trial_slope);
}

void TrapezoidalMethod::finish_solve() noexcept {
    if (options_.matrix == NewtonMatrix::broyden) broyden_direction();
    direction_ = true;
    step_ = solution_;
    residual_before_ = residual_;
    finish_tail();
}

/// The best iterate is used, and counted, unless it is no number.
Fault TrapezoidalMethod::give_up() noexcept {
    if (!std::isfinite(norm_)) return not_finite(w_.step);
    ++statistics_.unconverged;
    statistics_.worst = std::max(statistics_.worst, norm_);
    has_jacobian_ = false;
    finish_step();
    return {};
}

void TrapezoidalMethod::finish_step() noexcept {
    take_iterate();
    statistics_.iterations += iterations_;
    statistics_.refreshed += refreshed_ ? 1 : 0;
    statistics_.most = std::max<long>(statistics_.most, iterations_);
}

std::string TrapezoidalMethod::report() const { return text(statistics()); }

NewtonStatistics TrapezoidalMethod::statistics() const noexcept {
    NewtonStatistics all = statistics_;
    all.jacobians = jacobians_;
    all.factorisations = factorisations_;
    all.solves = solves_;
    return all;
}

// The trapezoidal rule's quasi-Newton variants: what becomes of the matrix between two iterations.

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

/// Sums the squares of the change over the unknowns of each row.
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

namespace {

[[nodiscard]] double dot(int size, const double* a, const double* b) noexcept {
    double sum = 0.0;
    for (int k = 0; k < size; ++k) sum += a[k] * b[k];
    return sum;
}

}  // namespace

Broyden::Broyden(int unknowns, int most)
    : unknowns_(unknowns), most_(most), steps_(static_cast<std::size_t>(unknowns * most)), updates_(steps_) {}

void Broyden::apply(double* x, int from) const noexcept {
    for (int k = from; k < count_; ++k) {
        const double share = dot(unknowns_, steps_.data() + k * unknowns_, x);
        const double* u = updates_.data() + k * unknowns_;
        for (int i = 0; i < unknowns_; ++i) x[i] += share * u[i];
    }
}

void Broyden::add(const double* s, const double* w) noexcept {
    const double along = dot(unknowns_, s, w);
    if (full() || !std::isfinite(along) || std::abs(along) < 1e-8 * dot(unknowns_, s, s)) return;
    std::copy_n(s, unknowns_, steps_.data() + count_ * unknowns_);
    double* u = updates_.data() + count_ * unknowns_;
    for (int i = 0; i < unknowns_; ++i) u[i] = (s[i] - w[i]) / along;
    ++count_;
}

void Broyden::visit(engine::Archive& archive) {
    archive("updates", count_, 0, static_cast<int>(steps_.size()) / std::max(1, unknowns_));
    for (std::vector<double>* part : {&steps_, &updates_})
        archive("update", std::span(part->data(), static_cast<std::size_t>(count_ * unknowns_)));
}

}  // namespace cvtflow::bench
