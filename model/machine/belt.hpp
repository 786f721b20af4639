#pragma once
/// The pitch path of the chain: two arcs and two tangents, or a ring.

#include <optional>

namespace cvtflow::model {

struct Point {
    double x, y;  ///< [m]
};
[[nodiscard]] constexpr Point operator+(Point a, Point b) noexcept { return {a.x + b.x, a.y + b.y}; }
[[nodiscard]] constexpr Point operator-(Point a, Point b) noexcept { return {a.x - b.x, a.y - b.y}; }
/// s [m]
[[nodiscard]] constexpr Point operator*(double s, Point a) noexcept { return {s * a.x, s * a.y}; }

/// Radii of an open belt over pulleys at (0, 0) and (a, 0), travelled counter-clockwise.
struct BeltRadii {
    double driving, driven;  ///< running radii of the two pulleys [m]
};

/// Length of the belt: 2 a cos φ + π (r1 + r2) + 2 φ (r2 - r1), sin φ = (r2 - r1)/a. Needs |r2 - r1| < a. centre_distance [m]
[[nodiscard]] double belt_length(const BeltRadii& radii, double centre_distance) noexcept;
/// Radii r2 = ratio r1 of a belt of the given length; none if no radii with r1 + r2 < a fit.
[[nodiscard]] std::optional<BeltRadii> belt_radii(double length, double ratio, double centre_distance) noexcept;

/// A closed path with arc length s, from the driving pulley's lower tangent point on: lower strand, driven arc, upper strand, driving arc.
class PitchPath {
public:
    /// Belt over two pulleys. centre_distance [m]
    PitchPath(const BeltRadii& radii, double centre_distance) noexcept;
    /// Ring of the given radius about the origin. radius [m]
    explicit PitchPath(double radius) noexcept;

    [[nodiscard]] double length() const noexcept { return length_; }
    /// Point at arc length s; s is taken modulo the length.
    [[nodiscard]] Point at(double s) const noexcept;
    /// Share of the way from the driving to the driven pulley: 0 on the driving arc, 1 on the driven arc, linear on the strands. s [m]
    [[nodiscard]] double side_at(double s) const noexcept;
    /// Smallest s' > s whose point has the given distance (chord) from the point at s. The chord must be shorter than the arcs' radii.
    [[nodiscard]] double advance(double s, double chord) const noexcept;
    /// advance() if the point at s is known. @param point at s before the call, at s' after it
    [[nodiscard]] double advance(double s, double chord, Point& point) const noexcept;

private:
    bool ring_;
    BeltRadii radii_;
    double centre_distance_;                             ///< [m]
    double incline_, sine_, cosine_;                     ///< φ [rad], and its functions [1]
    double strand_, driven_arc_, driving_arc_, length_;  ///< [m]
};

}  // namespace cvtflow::model
