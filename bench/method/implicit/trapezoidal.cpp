#include "bench/method/implicit/trapezoidal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tasks/step/step_method.hpp"

namespace cvtflow::bench {

namespace {

/// Least share of a Newton step that is tried: with a matrix of this iterate, and with an older one.
constexpr double shortest = 1.0 / 256.0, shortest_with_old = 1.0 / 8.0;
/// A matrix is given up when the residual falls by less than this factor, once it has had some iterations to show what it can: few if it is
/// kept over steps, many if it is of this step.
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

void TrapezoidalMethod::save(std::vector<double>& memory) const {
    const bool keeps = keeps_over_steps(options_.matrix) && has_jacobian_;
    memory = {end_slope_ ? 1.0 : 0.0, keeps ? 1.0 : 0.0, static_cast<double>(since_jacobian_)};
    if (end_slope_) memory.insert(memory.end(), w_.slopes[trial_slope], w_.slopes[trial_slope] + w_.layout().size());
    if (!keeps) return;
    broyden_.save(memory);
    save_factors(memory);
}

void TrapezoidalMethod::load(std::span<const double> memory) {
    if (memory.empty()) return;  // nothing has begun
    const auto flags = pop_front(memory, 2);
    end_slope_ = flags[0] != 0.0;
    const bool has_jacobian = flags[1] != 0.0;
    since_jacobian_ = pop_integer(memory, 0, std::numeric_limits<int>::max());
    if (end_slope_) std::ranges::copy(pop_front(memory, static_cast<std::size_t>(w_.layout().size())), w_.slopes[trial_slope]);
    has_jacobian_ = has_jacobian;
    if (has_jacobian_) static_cast<void>(load_factors(broyden_.load(memory)));
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

/// By the variant's rule.
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

}  // namespace cvtflow::bench
