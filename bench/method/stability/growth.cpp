#include "bench/method/stability/growth.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace cvtflow::bench {

namespace {

constexpr int first_judgement = 20;  // dimensions; then whenever they have doubled: eigenvalues of the Hessenberg matrix are expensive

/// Eigenvalues that count, the largest first.
[[nodiscard]] std::vector<std::complex<double>> candidates(const KrylovSpace& space, double from_one) {
    std::vector<std::complex<double>> values = space.values();
    std::erase_if(values, [&](const std::complex<double>& value) { return std::abs(value - 1.0) < from_one; });
    std::ranges::sort(values, std::ranges::greater{}, [](const std::complex<double>& value) { return std::abs(value); });
    return values;
}

void take(Growth& growth, const std::complex<double>& multiplier, const RitzVector& ritz) {
    growth.multiplier = multiplier;
    growth.factor = std::abs(multiplier);
    growth.uncertainty = ritz.residual;
    growth.real.clear();
    growth.imaginary.clear();
    for (const std::complex<double>& entry : ritz.vector) {
        growth.real.push_back(entry.real());
        growth.imaginary.push_back(entry.imag());
    }
}

/// The first one; another one that grows if more of its growth is certain.
void take_most_certain(Growth& growth, const KrylovSpace& space, const std::vector<std::complex<double>>& values) {
    for (const std::complex<double>& value : values) {
        if (&value != values.data() && std::abs(value) <= std::max(1.0, growth.certain())) break;
        Growth other;
        take(other, value, space.vector_of(value));
        if (&value != values.data() && other.certain() <= growth.certain()) continue;
        other.applications = growth.applications;
        growth = std::move(other);
    }
}

[[nodiscard]] Growth growth_from(int size, const LinearMap& map, const std::vector<double>& start, const GrowthSettings& settings) {
    KrylovSpace space(size, settings.most, start);
    Growth growth;
    double before = 0.0;
    int judge_at = first_judgement;
    for (bool settled = false; !settled && !space.full();) {
        ++growth.applications;
        if (!space.grow(map)) {
            growth.factor = std::numeric_limits<double>::infinity();
            return growth;
        }
        if (space.dimension() != judge_at) continue;
        judge_at *= 2;
        const std::vector<std::complex<double>> values = candidates(space, settings.from_one);
        const double now = values.empty() ? 0.0 : std::abs(values.front());
        settled = std::abs(now - before) < settings.settled * now;
        before = now;
    }
    take_most_certain(growth, space, candidates(space, settings.from_one));
    return growth;
}

}  // namespace

Growth fastest_growth(int size, const LinearMap& map, const std::vector<double>& start, const GrowthSettings& settings) {
    Growth growth = growth_from(size, map, start, settings);
    for (int k = 0; k < settings.restarts && growth.certain() < growth.factor; ++k) {
        const int applications = growth.applications;
        growth = growth_from(size, map, growth.real, settings);
        growth.applications += applications;
    }
    return growth;
}

}  // namespace cvtflow::bench
