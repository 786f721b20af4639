#include "bench/summary/peak.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>

#include "model/basis/lanes.hpp"

namespace cvtflow::bench {

namespace {

/// Eight independent chains of additions and of multiplications each.
template <int W>
double peak() {
    using model::Lanes;
    std::array<Lanes<W>, 16> value;
    for (std::size_t k = 0; k < value.size(); ++k) value[k] = Lanes<W>(1.0 + static_cast<double>(k));
    const Lanes<W> one(1.0);
    constexpr int rounds = 2'000'000;
    double best = 0.0;
    for (int repetition = 0; repetition < 5; ++repetition) {
        const auto begin = std::chrono::steady_clock::now();
        for (int round = 0; round < rounds; ++round) {
            for (std::size_t k = 0; k < 8; ++k) value[k] += one;
            for (std::size_t k = 8; k < 16; ++k) value[k] = value[k] * one;
        }
        benchmark::DoNotOptimize(value);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        best = std::max(best, 16.0 * W * rounds / seconds);
    }
    return best;
}

}  // namespace

double peak_flops(model::Isa isa) {
    if (isa > model::compiled_isa) return 0.0;
    return isa == model::Isa::baseline ? peak<2>() : isa == model::Isa::avx2 ? peak<4>() : peak<8>();
}

}  // namespace cvtflow::bench
