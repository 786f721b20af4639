#include "tests/oracle/belt_path.hpp"

#include <algorithm>
#include <numbers>
#include <stdexcept>

namespace cvtflow::oracle {

namespace {

constexpr Real pi = std::numbers::pi_v<Real>;

Vec2 direction(Real angle) { return {std::cos(angle), std::sin(angle)}; }

}  // namespace

BeltPath BeltPath::around_pulleys(Real radius, Real ratio, Real distance) {
    BeltPath path;
    path.radius_[0] = radius;
    path.radius_[1] = ratio * radius;
    path.axis_[1] = {distance, 0.0L};
    // Outward normals of the strands: (cos γ, ∓ sin γ) with a cos γ = r_1 - r_2.
    const Real angle = std::acos((radius - ratio * radius) / distance);
    const Real strand = distance * std::sin(angle);
    path.entry_[0] = angle;
    path.entry_[1] = -angle;
    path.lengths_[0] = strand;
    path.lengths_[1] = 2.0L * angle * path.radius_[1];
    path.lengths_[2] = strand;
    path.lengths_[3] = (2.0L * pi - 2.0L * angle) * path.radius_[0];
    return path;
}

BeltPath BeltPath::ring(Real radius) {
    BeltPath path;
    path.radius_[0] = radius;
    path.lengths_[3] = 2.0L * pi * radius;
    return path;
}

Real BeltPath::length() const { return lengths_[0] + lengths_[1] + lengths_[2] + lengths_[3]; }

BeltPath::Place BeltPath::at(Real along) const {
    Real rest = along - length() * std::floor(along / length());
    int part = 0;
    while (part < 3 && rest > lengths_[part]) rest -= lengths_[part++];
    const Real fraction = rest / lengths_[part];
    const int pulley = part == 1 || part == 2 ? 1 : 0;
    if (part == 1 || part == 3) {
        const Vec2 outward = direction(entry_[pulley] + rest / radius_[pulley]);
        return {axis_[pulley] + radius_[pulley] * outward, left_of(outward), static_cast<Part>(part), fraction};
    }
    // A strand leaves the driving arc below (part 0) or the driven arc above (part 2).
    const Vec2 outward = direction(part == 0 ? -entry_[0] : entry_[0]);
    const Vec2 tangent = left_of(outward);
    return {axis_[pulley] + radius_[pulley] * outward + rest * tangent, tangent, static_cast<Part>(part), fraction};
}

namespace {

Real pitch_of(const model::Parameters& parameters, int link) {
    const auto& pitch = parameters.chain.pitch;
    return pitch[static_cast<std::size_t>(link) % pitch.size()];
}

/// Marches along a path and keeps the contact normals of the joints from sweep to sweep.
struct Layer {
    const model::Parameters& parameters;
    const ChainTargets& targets;
    std::vector<Vec2> normal;  ///< ν_i, from R's arc centre to L's
    std::vector<Real> along;   ///< path coordinate of pin i's contact point, and of pin 0 once more at the end

    [[nodiscard]] int links() const { return parameters.chain.pins; }
    [[nodiscard]] int next(int i) const { return i + 1 == links() ? 0 : i + 1; }
    /// Distance from the contact point to either arc centre.
    [[nodiscard]] Real to_centre(int pin) const { return parameters.joint.radius - targets.depth[pin] / 2.0L; }
    /// Distance from the axis of a half to its arc centre, c_a.
    [[nodiscard]] Real arm() const { return parameters.joint.radius - parameters.half.width / 2.0L; }

    /// Vector from R's arc centre on pin i to L's on pin i+1: parallel to the link.
    [[nodiscard]] Vec2 between_centres(int link, Vec2 from, Vec2 to) const {
        return to - from + to_centre(link) * normal[link] + to_centre(next(link)) * normal[next(link)];
    }

    /// Path coordinate of the next pin at which the link has its length.
    [[nodiscard]] Real next_pin(const BeltPath& path, int link, Real from) const {
        const Real length = pitch_of(parameters, link) + parameters.half.width + targets.stretch[link];
        const Vec2 start = path.at(from).point;
        Real guess = from + pitch_of(parameters, link);
        for (int step = 0; step < 12; ++step) {
            const BeltPath::Place place = path.at(guess);
            const Vec2 d = between_centres(link, start, place.point);
            guess -= (norm(d) - 2.0L * arm() - length) / dot(unit(d), place.tangent);
        }
        return guess;
    }

    /// Lays all links. @return excess of the length of the chain over that of the path
    Real march(const BeltPath& path) {
        along.assign(1, 0.0L);
        for (int link = 0; link < links(); ++link) along.push_back(next_pin(path, link, along.back()));
        return along.back() - path.length();
    }

    [[nodiscard]] Vec2 travel(const BeltPath& path, int link) const {
        return unit(between_centres(link, path.at(along[link]).point, path.at(along[link + 1]).point));
    }

    /// Contact normals along the bisectors of the links just laid, plus the leans.
    void aim(const BeltPath& path) {
        std::vector<Vec2> aimed;
        for (int pin = 0; pin < links(); ++pin) {
            const Vec2 bisector = unit(travel(path, pin == 0 ? links() - 1 : pin - 1) + travel(path, pin));
            aimed.push_back(unit(bisector + targets.lean[pin] * left_of(bisector)));
        }
        normal = aimed;
    }
};

BeltPath path_of(const model::Parameters& parameters, Real radius) {
    if (parameters.detail.pulleys == model::PulleyDetail::absent) return BeltPath::ring(radius);
    return BeltPath::around_pulleys(radius, parameters.start.ratio, parameters.pulley.centre_distance);
}

/// The radius at which the path is as long as all pitches together.
Real start_radius(const model::Parameters& parameters) {
    Real target = 0.0L;
    for (int i = 0; i < parameters.chain.pins; ++i) target += pitch_of(parameters, i);
    Real low = 1e-3L;
    Real high = std::min(1.0L, 0.99L * parameters.pulley.centre_distance / std::abs(1.0L - parameters.start.ratio));
    for (int step = 0; step < 60; ++step) {
        const Real middle = (low + high) / 2.0L;
        (path_of(parameters, middle).length() > target ? high : low) = middle;
    }
    return low;
}

}  // namespace

LaidChain lay_chain(const model::Parameters& parameters, const ChainTargets& targets) {
    Layer layer{parameters, targets, {}, {}};
    Real radius = start_radius(parameters);
    const BeltPath first = path_of(parameters, radius);
    Real passed = 0.0L;
    for (int i = 0; i < layer.links(); ++i) {
        layer.normal.push_back(first.at(passed).tangent);
        passed += pitch_of(parameters, i);
    }
    const Real step = 1e-3L * radius;
    const Real per_radius = (path_of(parameters, radius + step).length() - path_of(parameters, radius - step).length()) / (2.0L * step);
    for (int sweep = 0; sweep < 250; ++sweep) {
        const BeltPath path = path_of(parameters, radius);
        radius += layer.march(path) / per_radius;
        layer.aim(path);
    }
    const BeltPath path = path_of(parameters, radius);
    if (!(std::abs(layer.march(path)) < 1e-9L)) throw std::runtime_error("the chain does not close");
    LaidChain chain{{}, {}, radius};
    for (int link = 0; link < layer.links(); ++link) {
        const int next = layer.next(link);
        const BeltPath::Place from = path.at(layer.along[link]);
        const BeltPath::Place to = path.at(layer.along[link + 1]);
        const Vec2 t = layer.travel(path, link);
        chain.rear.push_back({from.point - layer.to_centre(link) * layer.normal[link] + layer.arm() * t, from});
        chain.front.push_back({to.point + layer.to_centre(next) * layer.normal[next] - layer.arm() * t, to});
    }
    return chain;
}

}  // namespace cvtflow::oracle
