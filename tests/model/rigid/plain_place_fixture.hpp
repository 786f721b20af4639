#pragma once
/// Geometry of rigid pins, written plainly: halves, deflections of links and tips as functions of coordinates.

#include <array>
#include <cmath>
#include <vector>

#include "model/machine/coefficients.hpp"
#include "model/parameters/chain_layout.hpp"
#include "model/rigid/rigid_coefficients.hpp"
#include "tests/oracle/vectors.hpp"

namespace cvtflow::model::test {

using oracle::Real;
using oracle::Vec2;
using oracle::Vec3;
using Coordinates = std::vector<Real>;

/// Number by bisection: y² (1 + b y) = δ.
[[nodiscard]] inline Real root_of_depth(Real depth, Real softness) {
    Real low = 0.0L, high = std::sqrt(depth);
    for (int k = 0; k < 200; ++k) {
        const Real y = 0.5L * (low + high);
        (y * y * (1.0L + softness * y) < depth ? low : high) = y;
    }
    return 0.5L * (low + high);
}

/// The machine at one set of coordinates.
class Place {
public:
    Place(const Parameters& p, const Coordinates& z) : p_(p), z_(z), pins_(p.chain.pins) {}

    [[nodiscard]] Real coordinate(int k, int pin) const { return z_[static_cast<std::size_t>(k * pins_ + (pin + pins_) % pins_)]; }
    [[nodiscard]] Vec2 middle(int pin) const { return {coordinate(0, pin), coordinate(1, pin)}; }
    [[nodiscard]] Vec2 end(int pin) const { return {coordinate(3, pin), coordinate(4, pin)}; }
    [[nodiscard]] Real pulley(int k) const { return z_[static_cast<std::size_t>(rigid_coordinates * pins_ + k)]; }
    [[nodiscard]] bool elastic() const { return z_.size() == static_cast<std::size_t>(rigid_coordinates * pins_ + 36); }

    /// z of the front (+1) or rear (-1) half.
    [[nodiscard]] Real axial(int pin, Real which) const { return coordinate(2, pin) + which / 2.0L * coordinate(5, pin); }

    /// x_2 and y_2 of both halves.
    [[nodiscard]] Vec2 bend(int pin) const { return {coordinate(6, pin), coordinate(7, pin)}; }

    /// Angle of pitch line i, and direction.
    [[nodiscard]] Real angle(int i) const {
        const Vec2 d = middle(i + 1) - middle(i);
        return std::atan2(d.y, d.x);
    }
    [[nodiscard]] Vec2 line(int i) const { return {std::cos(angle(i)), std::sin(angle(i))}; }

    /// Middle of the front (+1) or rear (-1) half: arc centres 2ρ apart along the bisector, c_a before and behind the halves.
    [[nodiscard]] Vec2 half(int pin, Real which) const {
        const Real arm = p_.joint.radius - p_.half.width / 2.0L;
        const Vec2 before = line(pin - 1), behind = line(pin), bisector = oracle::unit(before + behind);
        return middle(pin) + (which / 2.0L) * (2.0L * p_.joint.radius * bisector - arm * (before + behind));
    }

    /// Deflections of link i: stretch, yaw, roll, shear, bow.
    [[nodiscard]] std::array<Real, 5> deflections(int i, Real square) const {
        const Vec2 d = half(i + 1, 1.0L) - half(i, -1.0L), t = oracle::unit(d), n = oracle::left_of(t);
        const Vec2 ends = end(i + 1) - end(i), both = end(i + 1) + end(i);
        const Real rise = axial(i + 1, 1.0L) - axial(i, -1.0L), length = free_length(i), roll = oracle::dot(ends, n);
        const Real stretch = oracle::norm(d) - length + (square * roll * roll + rise * rise) / (2.0L * length);
        return {stretch, oracle::dot(ends, t), roll, -2.0L / p_.half.length * oracle::dot(both, t) - 2.0L * rise / length,
                oracle::dot(bend(i + 1) - bend(i), t)};
    }
    [[nodiscard]] Real free_length(int i) const {
        const auto& pitch = p_.chain.pitch;
        return Real{pitch[static_cast<std::size_t>((i + pins_) % pins_) % pitch.size()]} + p_.half.width;
    }

    /// Of a power of Legendre's second polynomial, over the plates.
    [[nodiscard]] Real mean_shape(int power = 1) const {
        Parameters pack = p_;
        pack.detail.plates = PlateDetail::each;
        Real sum = 0.0L;
        for (const double xi : plate_positions(pack)) sum += std::pow(0.5L * (3.0L * xi * xi - 1.0L), power);
        return sum / p_.plate.count;
    }

    struct Sheave {
        Vec3 origin, tilt;
        Real turn;
    };
    [[nodiscard]] int shaft_of(int pin) const { return coordinate(0, pin) > p_.pulley.centre_distance / 2.0L ? 1 : 0; }
    [[nodiscard]] Sheave sheave(int shaft, int side) const {
        const Real plane = (side == 0 ? -0.5L : 0.5L) * p_.half.length, axis = shaft == 0 ? 0.0L : Real{p_.pulley.centre_distance};
        if (!elastic()) {
            const bool moves = (shaft == 0) == (side == 1);
            return {{axis, 0.0L, plane + (moves ? pulley(2 + shaft) : 0.0L)}, {}, pulley(shaft)};
        }
        const int b = body_freedom(sheave_body(shaft, side), 0);
        return {{axis + pulley(b), pulley(b + 1), plane + pulley(b + 4)}, {pulley(b + 2), pulley(b + 3), 0.0L}, pulley(b + 5)};
    }

    struct Tip {
        Vec3 end, centre, normal;  ///< E, S, G (the gradient of the depth, of length 1 to 1e-5)
        Vec3 round, flank;         ///< directions of sliding
        Real depth;
    };
    /// Tip of the front (+1) or rear (-1) half at side 0 or 1.
    [[nodiscard]] Tip tip(int pin, Real which, int side) const {
        const Real s = side == 0 ? -1.0L : 1.0L, sine = std::sin(Real{p_.tip.angle}), cosine = std::cos(Real{p_.tip.angle});
        const Sheave on = sheave(shaft_of(pin), side);
        const Vec2 t = line(which > 0.0L ? pin - 1 : pin), outward{t.y, -t.x},
                   slope = (2.0L / p_.half.length) * (end(pin) + 3.0L * s * bend(pin));
        Tip tip;
        tip.end = oracle::in_space(half(pin, which) + s * end(pin) + (1.0L - mean_shape()) * bend(pin),
                                   axial(pin, which) + s * p_.half.length / 2.0L);
        const Vec3 height = oracle::in_space(outward, -oracle::dot(slope, outward));
        tip.centre = tip.end + Real{p_.tip.radius} * (sine * height - s * cosine * oracle::in_space(slope, 1.0L));
        const Vec3 r = tip.centre - on.origin, l = r - oracle::cross(on.tilt, r);
        const Vec2 radial = oracle::unit(oracle::in_plane(l));
        const Real reach = Real{p_.pulley.arc_radius} + p_.tip.radius;
        const Real a = oracle::norm(oracle::in_plane(l)) - p_.pulley.arc_position - p_.tip.radius * sine;
        const Real h = -s * (l.z + s * p_.tip.radius * cosine);
        tip.depth = -(a * sine + h * cosine + (a * a + h * h) / (2.0L * reach));
        const Real out = sine + a / reach, in = cosine + h / reach;
        const Vec3 local = oracle::in_space(out * radial, -s * in);
        tip.normal = local + oracle::cross(on.tilt, local);
        tip.round = oracle::in_space(oracle::left_of(radial), 0.0L);
        tip.flank = oracle::in_space(in * radial, s * out);
        return tip;
    }

private:
    const Parameters& p_;
    const Coordinates& z_;
    int pins_;
};

}  // namespace cvtflow::model::test
