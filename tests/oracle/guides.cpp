/// Guides of the strands (EQUATIONS.md, section 8).

#include "tests/oracle/belt_path.hpp"
#include "tests/oracle/system.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::oracle {

namespace {

/// The path whose length is that of the chain.
BeltPath path_of(const model::Parameters& p) {
    Real length = 0.0L;
    for (int link = 0; link < p.chain.pins; ++link) length += p.chain.pitch[static_cast<std::size_t>(link) % p.chain.pitch.size()];
    const auto path = [&](Real radius) { return BeltPath::around_pulleys(radius, p.start.ratio, p.pulley.centre_distance); };
    Real low = 0.0L, high = p.pulley.centre_distance / (1.0L + p.start.ratio);
    for (int halving = 0; halving < 200; ++halving) {
        const Real middle = (low + high) / 2.0L;
        (path(middle).length() < length ? low : high) = middle;
    }
    return path(low);
}

/// Both rails of one strand.
struct Guide {
    Vec2 from, along, outward;  ///< beside where the strand leaves the driving pulley; unit vectors
    Real length;                ///< [m]
};

std::array<Guide, 2> guides_of(const model::Parameters& p) {
    const BeltPath path = path_of(p);  // begins with the lower strand
    const BeltPath::Place start = path.at(0.0L);
    const Real little = path.length() / 1000.0L, length = little / path.at(little).fraction;
    const auto mirrored = [](Vec2 v) { return Vec2{v.x, -v.y}; };
    const Vec2 outward = -left_of(start.tangent);
    const Vec2 middle = start.point + Real{p.guide.offset} * outward;
    return {Guide{middle, start.tangent, outward, length}, {mirrored(middle), mirrored(start.tangent), mirrored(outward), length}};
}

/// Force on a part of a pin at one guide; books energy and loss.
Vec2 guide_force(const model::Guide& p, const Guide& guide, Real part, Vec2 at, Vec2 rate, Totals& totals) {
    const Real s = dot(at + -guide.from, guide.along) / guide.length, u = dot(at + -guide.from, guide.outward);
    const Real rail = Real{p.end} - p.begin, ramp = rail / 5.0L;
    if (s < p.begin || s > p.end || std::abs(u) < p.clearance) return {};
    const bool entering = s - p.begin < p.end - s;
    const Real z = std::min(1.0L, (entering ? s - p.begin : p.end - s) / ramp);
    const Real slope = (entering ? 1.0L : -1.0L) * (z < 1.0L ? 6.0L * (z - z * z) : 0.0L) / (ramp * guide.length);
    const Real k = part * p.stiffness, w = 3.0L * z * z - 2.0L * z * z * z;
    const Vec2 pressing = u > 0.0L ? guide.outward : -guide.outward;
    const Real depth = std::abs(u) - p.clearance, approach = dot(rate, pressing);
    const Real normal = k * w * depth * std::max(0.0L, 1.0L + p.damping * approach);
    const Real speed = dot(rate, guide.along), friction = p.friction * normal * std::clamp(speed, -1.0L, 1.0L);
    totals.energies.supports += k * w * depth * depth / 2.0L;
    totals.loss(model::Loss::guide) += friction * speed + (normal - k * w * depth) * approach;
    return -normal * pressing + (-friction - k * slope * depth * depth / 2.0L) * guide.along;
}

}  // namespace

void add_guides(const System& system, Totals& totals) {
    const model::Guide& p = system.parameters.guide;
    if (!p.present()) return;
    const std::array<Guide, 2> guides = guides_of(system.parameters);
    const auto force = [&](Real part, Vec2 at, Vec2 rate) { return guide_force(p, guides[at.y > 0.0L ? 1 : 0], part, at, rate, totals); };
    for (std::size_t i = 0; i < system.links.size(); ++i) {
        for (const model::End end : {model::End::rear, model::End::front}) {
            const Half& half = system.links[i].half(end);
            totals.link[i].half(end).shape[0] += force(0.5L, half.shape[0], half.shape_rate[0]);
        }
    }
    for (std::size_t i = 0; i < system.pins.size(); ++i)
        totals.pin[i].middle += force(1.0L, system.pins[i].middle, system.pins[i].middle_rate);
}

}  // namespace cvtflow::oracle
