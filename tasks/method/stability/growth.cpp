#include "tasks/method/stability/growth.hpp"

#include <cmath>
#include <limits>

namespace cvtflow::tasks {

namespace {

constexpr int between_judgements = 10;

/// The largest, so far from 1 at least.
[[nodiscard]] std::complex<double> largest(const KrylovSpace& space, double from_one) {
    std::complex<double> largest = 0.0;
    for (const std::complex<double>& value : space.values()) {
        if (std::abs(value - 1.0) >= from_one && std::abs(value) > std::abs(largest)) largest = value;
    }
    return largest;
}

}  // namespace

Growth fastest_growth(int size, const LinearMap& map, const std::vector<double>& start, const GrowthSettings& settings) {
    KrylovSpace space(size, settings.most, start);
    Growth growth;
    double before = 0.0;
    for (bool settled = false; !settled && !space.full();) {
        ++growth.applications;
        if (!space.grow(map)) return {std::numeric_limits<double>::infinity(), {}, {}, {}, growth.applications};
        if (space.dimension() % between_judgements != 0) continue;
        const double now = std::abs(largest(space, settings.from_one));
        settled = std::abs(now - before) < settings.settled * now;
        before = now;
    }
    growth.multiplier = largest(space, settings.from_one);
    growth.factor = std::abs(growth.multiplier);
    for (const std::complex<double>& entry : space.vector_of(growth.multiplier)) {
        growth.real.push_back(entry.real());
        growth.imaginary.push_back(entry.imag());
    }
    return growth;
}

}  // namespace cvtflow::tasks
