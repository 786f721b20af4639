#include "engine/method/combine.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <tuple>
#include <utility>

namespace cvtflow::engine {

namespace {

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
