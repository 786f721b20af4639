#include "engine/method/compiled_plan.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <tuple>
#include <utility>

namespace cvtflow::engine {

namespace {

bool ends_at_result(const StagePlan& plan) {
    const Stage& last = plan.stages.back();
    const Combination& result = plan.result;
    if (plan.stages.size() < 2) return false;
    if (result.states == last.states && result.slopes == last.slopes) return true;
    return last.keep >= 0 && result.slopes.empty() && result.states == std::vector<Term>{{last.keep, 1.0}};
}

constexpr int chunk = 4;

struct Chunk {
    std::array<const double*, chunk> from;
    std::array<double, chunk> weight;
};

/// out = (first ? : out +) w_0 x_0 + … + w_{Terms-1} x_{Terms-1}, added from left to right.
template <int Terms, bool first>
void add_terms(const Chunk& terms, int size, double* __restrict out) noexcept {
    const double* __restrict x0 = terms.from[0];
    const double* __restrict x1 = terms.from[1];
    const double* __restrict x2 = terms.from[2];
    const double* __restrict x3 = terms.from[3];
    const auto [w0, w1, w2, w3] = terms.weight;
    for (int i = 0; i < size; ++i) {
        double sum = first ? w0 * x0[i] : out[i] + w0 * x0[i];
        if constexpr (Terms > 1) sum += w1 * x1[i];
        if constexpr (Terms > 2) sum += w2 * x2[i];
        if constexpr (Terms > 3) sum += w3 * x3[i];
        out[i] = sum;
    }
}

template <bool first>
void add_chunk(const Chunk& terms, int count, int size, double* out) noexcept {
    switch (count) {
        case 1: return add_terms<1, first>(terms, size, out);
        case 2: return add_terms<2, first>(terms, size, out);
        case 3: return add_terms<3, first>(terms, size, out);
        default: return add_terms<4, first>(terms, size, out);
    }
}

}  // namespace

CompiledPlan::CompiledPlan(const StagePlan& plan)
    : state_slots_(plan.state_slots), slope_slots_(plan.slope_slots), has_error_(plan.error.has_value()) {
    std::vector<double> state_times(static_cast<std::size_t>(plan.state_slots), 0.0);
    for (const Stage& stage : plan.stages) add(stage.states, stage.slopes, stage.keep, stage.slope, state_times);
    add(plan.result.states, plan.result.slopes, -1, -1, state_times);
    last_is_result_ = ends_at_result(plan);
    if (plan.error) add(plan.error->states, plan.error->slopes, -1, -1, state_times);
}

PlanStep CompiledPlan::step(int row) const noexcept {
    const Row& r = rows_[static_cast<std::size_t>(row)];
    const std::span<const Term> all(terms_);
    const auto begin = static_cast<std::size_t>(r.begin);
    const auto middle = static_cast<std::size_t>(r.middle);
    return {all.subspan(begin, middle - begin), all.subspan(middle, static_cast<std::size_t>(r.end) - middle), r.keep, r.slope, r.time};
}

/// The time of a combination, for y' = 1, y = t: every slope is 1, every state equals its time.
double CompiledPlan::time_of(int begin, int middle, int end, const std::vector<double>& state_times) const {
    double time = 0.0;
    for (int i = begin; i < middle; ++i) {
        const Term& term = terms_[static_cast<std::size_t>(i)];
        time += term.factor * state_times[static_cast<std::size_t>(term.slot)];
    }
    for (int i = middle; i < end; ++i) time += terms_[static_cast<std::size_t>(i)].factor;
    return time;
}

std::vector<std::vector<double>> CompiledPlan::unrolled() const {
    using Row = std::vector<double>;
    const auto stages = static_cast<std::size_t>(this->stages());
    std::vector<Row> rows, states(static_cast<std::size_t>(state_slots_), Row(stages, 0.0));  // states: [slot]
    std::vector<std::size_t> writer(static_cast<std::size_t>(slope_slots_), 0);               // [slope slot] the last stage
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        const PlanStep next = step(static_cast<int>(i));
        Row row(stages, 0.0);
        for (const Term& term : next.states) {
            const Row& from = states[static_cast<std::size_t>(term.slot)];
            for (std::size_t j = 0; j < stages; ++j) row[j] += term.factor * from[j];
        }
        for (const Term& term : next.slopes) row[writer[static_cast<std::size_t>(term.slot)]] += term.factor;
        if (next.slope >= 0) writer[static_cast<std::size_t>(next.slope)] = i;
        if (next.keep >= 0) states[static_cast<std::size_t>(next.keep)] = row;
        rows.push_back(std::move(row));
    }
    return rows;
}

void CompiledPlan::add(const std::vector<Term>& states, const std::vector<Term>& slopes, int keep, int slope,
                       std::vector<double>& state_times) {
    const int begin = static_cast<int>(terms_.size());
    terms_.insert(terms_.end(), states.begin(), states.end());
    const int middle = static_cast<int>(terms_.size());
    terms_.insert(terms_.end(), slopes.begin(), slopes.end());
    const int end = static_cast<int>(terms_.size());
    const double time = time_of(begin, middle, end, state_times);
    if (keep >= 0) state_times[static_cast<std::size_t>(keep)] = time;
    rows_.push_back({begin, middle, end, keep, slope, time});
}

void combine(const PlanStep& step, double h, const SlotView& slots, int begin, int end, double* out) noexcept {
    const std::size_t states = step.states.size();
    const std::size_t terms = states + step.slopes.size();
    const auto term = [&](std::size_t i) -> std::pair<const double*, double> {
        if (i < states) return {slots.states[step.states[i].slot] + begin, step.states[i].factor};
        const Term& slope = step.slopes[i - states];
        return {slots.slopes[slope.slot] + begin, h * slope.factor};
    };
    if (terms == 0) std::fill(out, out + (end - begin), 0.0);
    for (std::size_t done = 0; done < terms; done += chunk) {
        const std::size_t count = std::min<std::size_t>(chunk, terms - done);
        Chunk next{};
        for (std::size_t i = 0; i < count; ++i) std::tie(next.from[i], next.weight[i]) = term(done + i);
        if (done == 0) {
            add_chunk<true>(next, static_cast<int>(count), end - begin, out);
        } else {
            add_chunk<false>(next, static_cast<int>(count), end - begin, out);
        }
    }
}

}  // namespace cvtflow::engine
