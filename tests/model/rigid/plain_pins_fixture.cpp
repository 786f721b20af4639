#include "tests/model/rigid/plain_pins_fixture.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "model/machine/coefficients.hpp"
#include "tests/oracle/friction.hpp"
#include "tests/oracle/vectors.hpp"

namespace cvtflow::model::test {

namespace {

using oracle::Real;
using oracle::Vec2;
using oracle::Vec3;
using Coordinates = std::vector<Real>;

constexpr Vec3 k_axis{0.0L, 0.0L, 1.0L};

/// A length of time and of space over which things are differenced: short against 1 µm of a tip's depth, long against rounding.
constexpr Real instant = 1e-11L, displacement = 1e-11L;

/// The machine at one set of coordinates.
class Place {
public:
    Place(const Parameters& p, const Coordinates& z) : p_(p), z_(z), pins_(p.chain.pins) {}

    [[nodiscard]] Real coordinate(int k, int pin) const { return z_[static_cast<std::size_t>(k * pins_ + (pin + pins_) % pins_)]; }
    [[nodiscard]] Vec2 middle(int pin) const { return {coordinate(0, pin), coordinate(1, pin)}; }
    [[nodiscard]] Vec2 end(int pin) const { return {coordinate(3, pin), coordinate(4, pin)}; }
    [[nodiscard]] Real pulley(int k) const { return z_[static_cast<std::size_t>(5 * pins_ + k)]; }
    [[nodiscard]] bool elastic() const { return z_.size() == static_cast<std::size_t>(5 * pins_ + 36); }

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

    /// Deflections of link i: stretch, yaw, roll, shear.
    [[nodiscard]] std::array<Real, 4> deflections(int i, Real square) const {
        const Vec2 d = half(i + 1, 1.0L) - half(i, -1.0L), t = oracle::unit(d), n = oracle::left_of(t);
        const Vec2 ends = end(i + 1) - end(i), both = end(i + 1) + end(i);
        const Real rise = coordinate(2, i + 1) - coordinate(2, i), length = free_length(i), roll = oracle::dot(ends, n);
        const Real stretch = oracle::norm(d) - length + (square * roll * roll + rise * rise) / (2.0L * length);
        return {stretch, oracle::dot(ends, t), roll, -2.0L / p_.half.length * oracle::dot(both, t) - 2.0L * rise / length};
    }
    [[nodiscard]] Real free_length(int i) const {
        const auto& pitch = p_.chain.pitch;
        return Real{pitch[static_cast<std::size_t>((i + pins_) % pins_) % pitch.size()]} + p_.half.width;
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
        const Vec2 t = line(which > 0.0L ? pin - 1 : pin), outward{t.y, -t.x}, slope = (2.0L / p_.half.length) * end(pin);
        Tip tip;
        tip.end = oracle::in_space(half(pin, which) + s * end(pin), coordinate(2, pin) + s * p_.half.length / 2.0L);
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

[[nodiscard]] Coordinates moved(const Coordinates& z, const Coordinates& rate, Real time) {
    Coordinates to = z;
    for (std::size_t k = 0; k < z.size(); ++k) to[k] += time * rate[k];
    return to;
}

/// Number by bisection: y² (1 + b y) = δ.
[[nodiscard]] Real root_of_depth(Real depth, Real softness) {
    Real low = 0.0L, high = std::sqrt(depth);
    for (int k = 0; k < 200; ++k) {
        const Real y = 0.5L * (low + high);
        (y * y * (1.0L + softness * y) < depth ? low : high) = y;
    }
    return 0.5L * (low + high);
}

class Machine {
public:
    Machine(const Parameters& p, Coordinates z, Coordinates rate)
        : p_(p),
          z_(std::move(z)),
          rate_(std::move(rate)),
          before_z_(moved(z_, rate_, -instant)),
          after_z_(moved(z_, rate_, instant)),
          force_(z_.size()) {
        Parameters pack = p;
        pack.detail.plates = PlateDetail::each;
        for (const double xi : plate_positions(pack)) square_ += Real{xi} * xi / p.plate.count;
        half_mass_ = p.half.mass + 0.5L * p.plate.count * p.plate.mass;
        softness_ = p.tip.hertz * std::pow(std::cos(Real{p.tip.angle}), 2) * p.half.length / (2.0L * p.chain.young_modulus * p.half.area);
    }

    void run() {
        for (int i = 0; i < p_.chain.pins; ++i) link(i);
        for (int pin = 0; pin < p_.chain.pins; ++pin) {
            roll(pin);
            if (z_.size() == static_cast<std::size_t>(5 * p_.chain.pins)) continue;
            for (const Real which : {1.0L, -1.0L})
                for (int side = 0; side < 2; ++side) tip(pin, which, side);
        }
    }
    [[nodiscard]] const Coordinates& force() const { return force_; }
    [[nodiscard]] Real inertia(int k) const {
        const Real plates = p_.plate.count * Real{p_.plate.mass};
        return k < 3 ? 2.0L * p_.half.mass + plates : p_.detail.mass_scaling * (2.0L * p_.half.mass / 3.0L + plates * square_);
    }
    Real energy = 0.0L, lost = 0.0L;

private:
    using Measure = std::function<Real(const Place&)>;

    [[nodiscard]] Real now(const Measure& of) const { return of(Place(p_, z_)); }
    [[nodiscard]] Real rate(const Measure& of) const { return (of(Place(p_, after_z_)) - of(Place(p_, before_z_))) / (2.0L * instant); }

    /// The force F on whatever lengthens: its virtual work goes to the coordinates of pins around `pin` and to the pulleys.
    void push(const Measure& length, Real force, int pin) {
        const int pins = p_.chain.pins;
        const auto differentiate = [&](std::size_t k) {
            const Real at = z_[k];
            z_[k] = at + displacement;
            const Real more = now(length);
            z_[k] = at - displacement;
            const Real less = now(length);
            z_[k] = at;
            force_[k] += force * (more - less) / (2.0L * displacement);
        };
        for (int near = pin - 2; near <= pin + 3; ++near)
            for (int k = 0; k < 5; ++k) differentiate(static_cast<std::size_t>(k * pins + (near + pins) % pins));
        for (std::size_t k = static_cast<std::size_t>(5 * pins); k < z_.size(); ++k) differentiate(k);
    }

    [[nodiscard]] Real damping(Real stiffness, Real mass) const { return 2.0L * p_.chain.damping_ratio * std::sqrt(stiffness * mass); }

    void spring(const Measure& length, Real stiffness, Real viscosity, int pin) {
        const Real u = now(length), speed = rate(length);
        push(length, -(stiffness * u + viscosity * speed), pin);
        energy += 0.5L * stiffness * u * u;
        lost += viscosity * speed * speed;
    }

    void link(int i) {
        const Real per_half = 2.0L / p_.half.length, length = Place(p_, z_).free_length(i);
        const Real plates = p_.plate.count * Real{p_.plate.stiffness}, joint = p_.joint.stiffness;
        const Real pull = 1.0L / (1.0L / plates + 1.0L / joint), pull_damping = damping(pull, 0.5L * half_mass_);
        const Real pack_yaw = 1.0L / (1.0L / (plates * square_) + 3.0L / joint);
        const Real tilt = p_.detail.mass_scaling * 0.5L * p_.half.mass / 3.0L * std::pow(0.5L * p_.half.length, 2);
        const Real bending = p_.plate.count * Real{p_.plate.bending_stiffness} / length,
                   torsion = p_.plate.count * Real{p_.plate.torsion_stiffness};
        const auto deflection = [this, i](std::size_t which) {
            return [this, i, which](const Place& at) { return at.deflections(i, square_)[which]; };
        };
        spring(deflection(0), pull, pull_damping, i);
        tension_ = pull * now(deflection(0)) + pull_damping * rate(deflection(0));
        spring(deflection(1), pack_yaw + per_half * per_half * bending,
               pull_damping * square_ + per_half * per_half * damping(bending, tilt), i);
        spring(deflection(2), per_half * per_half * torsion, per_half * per_half * damping(torsion, tilt), i);
        spring(deflection(3), 3.0L * bending, damping(3.0L * bending, tilt), i);
        const Measure rise = [i](const Place& at) { return at.coordinate(2, i + 1) - at.coordinate(2, i); };
        rub(rise, p_.plate.friction, std::max(0.0L, tension_), i);
    }

    void rub(const Measure& length, const Friction& friction, Real normal, int pin) {
        const Real v = rate(length), force = friction.coefficient * normal * oracle::friction_slope(p_.detail, friction, std::abs(v)) * v;
        push(length, -force, pin);
        lost += force * v;
    }

    /// Resistance to rolling: the force with which the links of a pin press its halves together, on the angle between them.
    void roll(int pin) {
        const auto pull = [&](int i) -> Vec2 {  // on the front half of link i: the gradient of its energy, and damping
            Vec2 f{};
            const auto of_half = [&](Vec2 shift) {
                return [this, i, shift](const Place& at) { return link_energy_shifted(at, i, shift); };
            };
            for (int axis = 0; axis < 2; ++axis) {
                const Vec2 e = axis == 0 ? Vec2{1.0L, 0.0L} : Vec2{0.0L, 1.0L};
                (axis == 0 ? f.x : f.y) = -(now(of_half(displacement * e)) - now(of_half(-displacement * e))) / (2.0L * displacement);
            }
            return f;
        };
        const Place at(p_, z_);
        const Vec2 bisector = oracle::unit(at.line(pin - 1) + at.line(pin));
        const Real pressing = std::max(0.0L, -oracle::dot(0.5L * (pull(pin - 1) + pull(pin)), bisector));
        const Real strip = 0.11L * std::sqrt(p_.joint.radius * pressing / p_.joint.stiffness);
        const Measure angle = [pin](const Place& there) {
            const Vec2 a = there.line(pin - 1), b = there.line(pin);
            return std::atan2(oracle::cross(a, b), oracle::dot(a, b));
        };
        const Real v = strip * rate(angle);
        const Real force = p_.joint.friction.coefficient * pressing * oracle::friction_slope(p_.detail, p_.joint.friction, std::abs(v)) * v;
        push(angle, -strip * force, pin);
        lost += force * v;
    }

    /// Work done against link i by a shift of its front half in the plane: its energy, with dampers pulling as they do now.
    [[nodiscard]] Real link_energy_shifted(const Place& at, int i, Vec2 shift) const {
        const Real per_half = 2.0L / p_.half.length, length = at.free_length(i);
        const Vec2 d = at.half(i + 1, 1.0L) - at.half(i, -1.0L) + shift, t = oracle::unit(d), n = oracle::left_of(t);
        const Vec2 ends = at.end(i + 1) - at.end(i), both = at.end(i + 1) + at.end(i);
        const Real rise = at.coordinate(2, i + 1) - at.coordinate(2, i), roll = oracle::dot(ends, n);
        const std::array<Real, 4> u{oracle::norm(d) - length + (square_ * roll * roll + rise * rise) / (2.0L * length),
                                    oracle::dot(ends, t), roll, -per_half * oracle::dot(both, t) - 2.0L * rise / length};
        const Real plates = p_.plate.count * Real{p_.plate.stiffness}, joint = p_.joint.stiffness;
        const Real pull = 1.0L / (1.0L / plates + 1.0L / joint), bending = p_.plate.count * Real{p_.plate.bending_stiffness} / length;
        const Real torsion = p_.plate.count * Real{p_.plate.torsion_stiffness};
        const Real tilt = p_.detail.mass_scaling * 0.5L * p_.half.mass / 3.0L * std::pow(0.5L * p_.half.length, 2);
        const Real pack_yaw = 1.0L / (1.0L / (plates * square_) + 3.0L / joint), square = per_half * per_half;
        const std::array<Real, 4> k{pull, pack_yaw + square * bending, square * torsion, 3.0L * bending};
        const Real pull_damping = damping(pull, 0.5L * half_mass_);
        const std::array<Real, 4> c{pull_damping, pull_damping * square_ + square * damping(bending, tilt), square * damping(torsion, tilt),
                                    damping(3.0L * bending, tilt)};
        Real work = 0.0L;
        for (std::size_t which = 0; which < 4; ++which) {
            const Measure of = [this, i, which](const Place& there) { return there.deflections(i, square_)[which]; };
            work += 0.5L * k[which] * u[which] * u[which] + c[which] * rate(of) * u[which];
        }
        return work;
    }

    void tip(int pin, Real which, int side) {
        const Measure depth = [=](const Place& at) { return at.tip(pin, which, side).depth; };
        const Real delta = now(depth);
        if (delta <= 0.0L) return;
        const Real hertz = p_.tip.hertz, y = root_of_depth(delta, softness_), elastic = hertz * y * y * y, speed = rate(depth);
        const Real reference = p_.tip.reference_depth, mass = p_.half.mass;
        const Real chi = damping(1.5L * hertz * std::sqrt(reference), mass) / (hertz * reference * std::sqrt(reference));
        const Real normal = elastic * std::max(0.0L, 1.0L + chi * speed);
        push(depth, -normal, pin);
        energy += hertz * std::pow(y, 5) * (0.4L + 0.5L * softness_ * y);
        lost += (normal - elastic) * speed;
        slide(pin, which, side, normal, y);
    }

    /// Friction along both directions: velocities of the half's material point against the sheave's, and their virtual work.
    void slide(int pin, Real which, int side, Real normal, Real y) {
        const Place here(p_, z_);
        const Place::Tip tip = here.tip(pin, which, side);
        const int shaft = here.shaft_of(pin), line = which > 0.0L ? pin - 1 : pin;
        const Real s = side == 0 ? -1.0L : 1.0L;
        const Real share = 3.0L * softness_ * y / (2.0L + 3.0L * softness_ * y) / std::cos(Real{p_.tip.angle});
        const Vec3 point = tip.centre - Real{p_.tip.radius} * tip.normal;
        const Vec3 reach = point - tip.end, arm = point - here.sheave(shaft, side).origin;
        // What a small motion moves at the point of contact along a direction fixed now.
        const auto along = [=, this](Vec3 direction) -> Measure {
            return [=, this](const Place& at) {
                const Place::Tip there = at.tip(pin, which, side);
                const Place::Sheave now_on = at.sheave(shaft, side), on = Place(p_, start_).sheave(shaft, side);
                const Real turned = at.angle(line) - Place(p_, start_).angle(line);
                const Vec3 spun{now_on.tilt.x - on.tilt.x, now_on.tilt.y - on.tilt.y, now_on.turn - on.turn};
                const Vec3 half = there.end + turned * oracle::cross(k_axis, reach) - (s * share * there.depth) * k_axis;
                return oracle::dot(direction, half - (now_on.origin + oracle::cross(spun, arm)));
            };
        };
        start_ = z_;
        const Measure round = along(tip.round), flank = along(tip.flank);
        const Real u = rate(round), v = rate(flank), speed = std::hypot(u, v);
        const Real factor = p_.tip.friction.coefficient * normal * oracle::friction_slope(p_.detail, p_.tip.friction, speed);
        push(round, -factor * u, pin);
        push(flank, -factor * v, pin);
        lost += factor * speed * speed;
    }

    const Parameters& p_;
    Coordinates z_, rate_, before_z_, after_z_, force_, start_;
    Real square_ = 0.0L, half_mass_ = 0.0L, softness_ = 0.0L, tension_ = 0.0L;
};

}  // namespace

PlainMotion plain_motion(const Parameters& parameters, const std::vector<double>& coordinates, const std::vector<double>& velocities,
                         const std::vector<double>& inertia) {
    Machine machine(parameters, Coordinates(coordinates.begin(), coordinates.end()), Coordinates(velocities.begin(), velocities.end()));
    machine.run();
    PlainMotion motion;
    const std::size_t pins = static_cast<std::size_t>(parameters.chain.pins);
    for (std::size_t k = 0; k < coordinates.size(); ++k) {
        const Real mass = k < 5 * pins ? machine.inertia(static_cast<int>(k / pins)) : Real{inertia[k - 5 * pins]};
        motion.acceleration.push_back(static_cast<double>(machine.force()[k] / mass));
    }
    motion.energy = static_cast<double>(machine.energy);
    motion.lost = static_cast<double>(machine.lost);
    return motion;
}

}  // namespace cvtflow::model::test
