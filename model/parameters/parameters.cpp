#include "model/parameters/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace cvtflow::model {

double TimeTable::at(double t) const noexcept {
    if (t <= time.front()) return value.front();
    if (t >= time.back()) return value.back();
    const auto after = static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), t) - time.begin());
    const double fraction = (t - time[after - 1]) / (time[after] - time[after - 1]);
    return value[after - 1] + fraction * (value[after] - value[after - 1]);
}

double TimeTable::integral(double t) const noexcept {
    if (t <= 0.0) return at(0.0) * t;
    double sum = 0.0;
    double from = 0.0;
    for (const double knot : time) {
        if (knot <= from) continue;
        if (knot >= t) break;
        sum += 0.5 * (at(from) + at(knot)) * (knot - from);
        from = knot;
    }
    return sum + 0.5 * (at(from) + at(t)) * (t - from);
}

double TimeTable::largest_magnitude() const noexcept {
    double largest = 0.0;
    for (const double v : value) largest = std::max(largest, std::abs(v));
    return largest;
}

double chain_length(const Chain& chain) noexcept {
    double length = 0.0;
    for (int link = 0; link < chain.pins; ++link) length += chain.pitch[static_cast<std::size_t>(link) % chain.pitch.size()];
    return length;
}

double ramp(const Start& start, double t) noexcept {
    if (t >= 0.0) return 1.0;
    const double x = std::clamp((t + start.settling_time) / start.ramp_time, 0.0, 1.0);
    return x * x * (3.0 - 2.0 * x);
}

}  // namespace cvtflow::model
