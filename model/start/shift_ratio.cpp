#include "model/start/shift_ratio.hpp"

#include <array>
#include <numbers>

#include "model/basis/portable_math.hpp"
#include "model/force/pulley_inputs.hpp"
#include "model/parameters/chain_layout.hpp"

namespace cvtflow::model {

namespace {

/// The pitch path at a ratio, its arc length counted from the upper strand's crossing of the middle between the shafts.
struct RunningPath {
    RunningPath(const BeltRadii& radii, double centre_distance) : path(radii, centre_distance), speed(radii.driving) {
        const double rise = radii.driven - radii.driving;
        const double incline = portable_asin(rise / centre_distance), strand = centre_distance * portable_cos(incline);
        const double to_middle = (0.5 * centre_distance - radii.driven * rise / centre_distance) / portable_cos(incline);
        middle = strand + radii.driven * (std::numbers::pi + 2.0 * incline) + to_middle;
    }
    /// Direction times the speed of the chain for a unit speed of shaft 1. along [m]
    [[nodiscard]] Point motion(double along) const noexcept {
        constexpr double step = 1e-4;  // [m]
        return 0.5 * speed / step * (path.at(middle + along + step) - path.at(middle + along - step));
    }

    PitchPath path;
    double speed;   ///< [m]
    double middle;  ///< [m]
};

/// Moves a half, or a rigid pin, by what its place on the path moves. q: of its block [link_size], along [m], axial of both arcs [m]
void move(const ChainLayout& at, End end, double along, const RunningPath& before, const RunningPath& after,
          const std::array<double, 2>& axial, double* q) noexcept {
    double* const v = q + at.link_size();
    const int x = at.x(end, 0), y = at.y(end, 0);
    const Point moved = after.path.at(after.middle + along) - before.path.at(before.middle + along);
    const Point was = before.motion(along), is = after.motion(along);
    const double turning = (v[x] * was.x + v[y] * was.y) / (was.x * was.x + was.y * was.y);  // of shaft 1, without slip
    const double side = before.path.side_at(before.middle + along);
    q[x] += moved.x;
    q[y] += moved.y;
    q[at.z(end)] += axial[0] + side * (axial[1] - axial[0]);
    v[x] += turning * (is.x - was.x);
    v[y] += turning * (is.y - was.y);
}

}  // namespace

std::optional<BeltRadii> chain_radii(const Parameters& p, double ratio) noexcept {
    return belt_radii(chain_length(p.chain), ratio, p.pulley.centre_distance);
}

bool shift_ratio(const Parameters& p, double from, double to, double* state) noexcept {
    const auto old_radii = chain_radii(p, from), new_radii = chain_radii(p, to);
    const ChainLayout at = layout_of(p);
    if (!old_radii || !new_radii || at.pulley_size == 0) return false;
    const RunningPath before(*old_radii, p.pulley.centre_distance), after(*new_radii, p.pulley.centre_distance);
    PulleyCoordinates coordinates;
    coordinates.adopt(p);
    double* const pulleys = state + at.pulley_begin();
    std::array<double, 2> axial{};
    for (int shaft = 0; shaft < 2; ++shaft) {
        const double wider = shaft == 0 ? old_radii->driving - new_radii->driving : old_radii->driven - new_radii->driven;
        const double moved = movable_side(shaft) * wider / coordinates.narrowing();
        pulleys[coordinates.movable(shaft)] += moved;
        axial[static_cast<std::size_t>(shaft)] = 0.5 * moved;
    }
    const double change = (from / to - 1.0) * coordinates.shaft_speed(pulleys, 1);
    pulleys[at.pulley_size + coordinates.rotation(1)] += change;
    for (int side = 0; coordinates.elastic() && side < 2; ++side) pulleys[at.pulley_size + coordinates.sheave_rotation(1, side)] += change;
    const auto pin = [&](int link) {
        const double* q = state + at.link_begin(at.wrapped(link));
        return Point{q[at.x(End::rear, 0)], q[at.y(End::rear, 0)]};
    };
    const auto pitch = [](Point from, Point to) { return portable_hypot(to.x - from.x, to.y - from.y); };
    double length = 0.0, along = 0.5 * p.pulley.centre_distance - pin(0).x;
    for (int link = 0; link < at.links; ++link) length += pitch(pin(link), pin(link + 1));
    const double scale = before.path.length() / length;
    for (int link = 0; link < at.links; ++link) {
        const double next = along + scale * pitch(pin(link), pin(link + 1));
        double* const q = state + at.link_begin(link);
        move(at, End::rear, along, before, after, axial, q);
        if (!at.rigid) move(at, End::front, next, before, after, axial, q);
        along = next;
    }
    return true;
}

}  // namespace cvtflow::model
