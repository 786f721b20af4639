#include "bench/method/implicit/linear_method.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace cvtflow::bench {

namespace {

/// Terms by stage as terms by state slot: stage i keeps its increment in slot i + 1.
std::vector<engine::Term> by_slot(const std::vector<engine::Term>& terms, bool with_start) {
    std::vector<engine::Term> all;
    if (with_start) all.push_back({0, 1.0});
    for (const engine::Term& term : terms) all.push_back({term.slot + 1, term.factor});
    return all;
}

/// out += factor A x.   A: [rows × columns]
void add_product(int rows, int columns, double factor, const double* a, const double* x, double* out) noexcept {
    for (int row = 0; row < rows; ++row) {
        double sum = 0.0;
        for (int k = 0; k < columns; ++k) sum += a[row * columns + k] * x[k];
        out[row] += factor * sum;
    }
}

}  // namespace

LinearMethod::LinearMethod(Workspace& workspace, const LinearPlan& plan)
    : ImplicitMethod(workspace),
      plan_(plan),
      times_(times_of(plan)),
      result_(by_slot(plan.result, true)),
      right_q_(static_cast<std::size_t>(w_.layout().coordinates())),
      reactions_(static_cast<std::size_t>(w_.layout().links * border_size_)) {
    for (const LinearStage& stage : plan_.stages) {
        states_.push_back(by_slot(stage.states, true));
        rights_.push_back(by_slot(stage.right, false));
    }
    exact_ = true;
}

double LinearMethod::theta() const noexcept { return plan_.stages[stage_].gamma * w_.step.h; }

CycleSequence LinearMethod::step() {
    for (stage_ = 0; stage_ < plan_.stages.size(); ++stage_) {
        co_yield evaluate(states_[stage_], times_.stage[stage_], stage_slope);
        close_evaluation(w_);
        const bool known = has_jacobian_ && time_of_jacobian_ == w_.step.time;  // of the same step, retaken from the same state
        if (stage_ == 0 && !known) {
            has_jacobian_ = true;
            time_of_jacobian_ = w_.step.time;
            co_yield take_jacobian(0.0, 0, stage_slope);
        }
        if (stage_ == 0 || theta() != theta_) {
            co_yield factorise(theta());
            if (!matrix_.sound()) co_return not_finite(w_.step);
        }
        co_yield prepare_cycle;
        prepare_tail();
        ++solves_;
        co_yield solve_cycle;
        finish_stage();
    }
    w_.step.row = {result_, {}, -1, -1, 1.0};
    co_return {};
}

/// r_q = θ v + γ Σ c u over a range of coordinates.
void LinearMethod::coordinates_right(int begin, int size, double* out) const noexcept {
    const double gamma = plan_.stages[stage_].gamma;
    for (int k = 0; k < size; ++k) {
        double sum = w_.step.h * w_.slopes[stage_slope][begin + k];
        for (const engine::Term& term : rights_[stage_]) sum += term.factor * state(term.slot)[begin + k];
        out[k] = gamma * sum;
    }
}

void LinearMethod::prepare(int segment) noexcept {
    for (int link = w_.partition[segment].first; link < w_.partition[segment].last; ++link) prepare_link(link);
}

void LinearMethod::prepare_link(int link) noexcept {
    const model::ChainLayout& at = w_.layout();
    double* r = velocities(right_side_, link);
    coordinates_right(at.link_begin(link) + size_, size_, r);
    const int near[3] = {at.previous(link), link, at.next(link)};
    double coordinates[4 * model::axis_terms + 4];
    for (int n = 0; n < 3; ++n) {
        coordinates_right(at.link_begin(near[n]), size_, coordinates);
        add_product(size_, size_, theta(), jacobian_.link(link, static_cast<bench::Near>(n), bench::With::position), coordinates, r);
        if (n == 1) std::copy_n(coordinates, size_, right_q_.data() + link * size_);
    }
    if (half_ == 0) return;
    double* reaction = reactions_.data() + link * border_size_;
    std::fill_n(reaction, border_size_, 0.0);
    if (!ContactMap{w_.tips.phases.data(), w_.links.loads.data()}.shaft(link).has_value()) return;
    double pulleys[36 + 1] = {};
    coordinates_right(q_tail_, half_, pulleys);
    add_product(size_, border_size_, theta(), jacobian_.columns(link, bench::With::position), pulleys, r);
    add_product(border_size_, size_, theta(), jacobian_.rows(link, bench::With::position), right_q_.data() + link * size_, reaction);
}

void LinearMethod::prepare_tail() noexcept {
    if (half_ == 0) return;
    double* r = border(right_side_);
    coordinates_right(q_tail_ + half_, border_size_, r);
    double pulleys[36 + 1] = {};
    coordinates_right(q_tail_, half_, pulleys);
    std::copy_n(pulleys, half_, right_q_.end() - half_);
    add_product(border_size_, border_size_, theta(), jacobian_.corner(bench::With::position), pulleys, r);
    for (int link = 0; link < w_.layout().links; ++link) {
        for (int k = 0; k < border_size_; ++k) r[k] += reactions_[static_cast<std::size_t>(link * border_size_ + k)];
    }
}

void LinearMethod::finish(int first, int last) noexcept {
    for (int link = first; link < last; ++link) {
        double* u = state(static_cast<int>(stage_) + 1) + w_.layout().link_begin(link);
        const double* x = velocities(solution_, link);
        for (int k = 0; k < size_; ++k) {
            u[k] = right_q_[static_cast<std::size_t>(link * size_ + k)] + theta() * x[k];
            u[size_ + k] = x[k];
        }
    }
}

void LinearMethod::finish_stage() noexcept {
    double* u = state(static_cast<int>(stage_) + 1) + q_tail_;
    for (int k = 0; k < border_size_; ++k) u[half_ + k] = border(solution_)[k];
    for (int k = 0; k < half_; ++k) u[k] = *(right_q_.end() - half_ + k) + theta() * border(solution_)[k];
    const int ledger = w_.layout().ledger_begin();
    coordinates_right(ledger, w_.layout().size() - ledger, state(static_cast<int>(stage_) + 1) + ledger);
}

std::string LinearMethod::report() const {
    return fmt::format("{} Jacobians, {} factorisations, {} solves", jacobians_, factorisations_, solves_);
}

}  // namespace cvtflow::bench
