#include "model/machine/belt.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "model/basis/portable_math.hpp"

namespace cvtflow::model {

namespace {
constexpr double pi = std::numbers::pi;
}

double belt_length(const BeltRadii& radii, double centre_distance) noexcept {
    const double incline = portable_asin((radii.driven - radii.driving) / centre_distance);
    return 2.0 * centre_distance * portable_cos(incline) + pi * (radii.driving + radii.driven) +
           2.0 * incline * (radii.driven - radii.driving);
}

std::optional<BeltRadii> belt_radii(double length, double ratio, double centre_distance) noexcept {
    const auto pair = [ratio](double driving) { return BeltRadii{driving, ratio * driving}; };
    double low = 0.0;
    double high = centre_distance / (1.0 + ratio);  // the pulleys touch
    if (!(belt_length(pair(low), centre_distance) < length) || !(belt_length(pair(high), centre_distance) > length)) return std::nullopt;
    for (int iteration = 0; iteration < 200; ++iteration) {
        const double middle = 0.5 * (low + high);
        (belt_length(pair(middle), centre_distance) < length ? low : high) = middle;
    }
    return pair(0.5 * (low + high));
}

PitchPath::PitchPath(const BeltRadii& radii, double centre_distance) noexcept
    : ring_(false),
      radii_(radii),
      centre_distance_(centre_distance),
      incline_(portable_asin((radii.driven - radii.driving) / centre_distance)),
      sine_(portable_sin(incline_)),
      cosine_(portable_cos(incline_)),
      strand_(centre_distance * cosine_),
      driven_arc_(radii.driven * (pi + 2.0 * incline_)),
      driving_arc_(radii.driving * (pi - 2.0 * incline_)),
      length_(2.0 * strand_ + driven_arc_ + driving_arc_) {}

PitchPath::PitchPath(double radius) noexcept
    : ring_(true),
      radii_{radius, radius},
      centre_distance_(0.0),
      incline_(0.0),
      sine_(0.0),
      cosine_(1.0),
      strand_(0.0),
      driven_arc_(0.0),
      driving_arc_(0.0),
      length_(2.0 * pi * radius) {}

Point PitchPath::at(double s) const noexcept {
    s -= length_ * std::floor(s / length_);
    if (ring_) return {radii_.driving * portable_cos(s / radii_.driving), radii_.driving * portable_sin(s / radii_.driving)};
    if (s < strand_) return {-radii_.driving * sine_ + s * cosine_, -radii_.driving * cosine_ - s * sine_};
    s -= strand_;
    if (s < driven_arc_) {
        const double angle = -0.5 * pi - incline_ + s / radii_.driven;
        return {centre_distance_ + radii_.driven * portable_cos(angle), radii_.driven * portable_sin(angle)};
    }
    s -= driven_arc_;
    if (s < strand_) return {centre_distance_ - radii_.driven * sine_ - s * cosine_, radii_.driven * cosine_ - s * sine_};
    const double angle = 0.5 * pi + incline_ + (s - strand_) / radii_.driving;
    return {radii_.driving * portable_cos(angle), radii_.driving * portable_sin(angle)};
}

double PitchPath::side_at(double s) const noexcept {
    s -= length_ * std::floor(s / length_);
    if (ring_) return 0.0;
    if (s < strand_) return s / strand_;
    s -= strand_;
    if (s < driven_arc_) return 1.0;
    s -= driven_arc_;
    return s < strand_ ? 1.0 - s / strand_ : 0.0;
}

double PitchPath::advance(double s, double chord) const noexcept {
    Point point = at(s);
    return advance(s, chord, point);
}

double PitchPath::advance(double s, double chord, Point& point) const noexcept {
    constexpr int most = 60;
    const Point from = point;
    double to = s + chord, before = s;
    for (int iteration = 1; iteration <= most; ++iteration) {  // the chord grows almost as fast as the arc: a contraction
        point = at(to);
        const double error = chord - portable_hypot(point.x - from.x, point.y - from.y);
        const double next = to + error;
        if (next == to) return to;
        const bool near = std::abs(error) < 1e-17, to_and_fro = next == before;  // between two neighbours until the last iteration
        if (!near && to_and_fro && (most - iteration) % 2 != 0) return to;
        before = std::exchange(to, next);
        if (near || to_and_fro) break;
    }
    point = at(to);
    return to;
}

}  // namespace cvtflow::model
