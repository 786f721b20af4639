#include "tests/model/rigid/plain_pins_fixture.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "model/machine/coefficients.hpp"
#include "tests/model/rigid/plain_place_fixture.hpp"
#include "tests/oracle/friction.hpp"

namespace cvtflow::model::test {

namespace {

constexpr Vec3 k_axis{0.0L, 0.0L, 1.0L};

/// A length of time and of space over which things are differenced: short against 1 µm of a tip's depth, long against rounding.
constexpr Real instant = 1e-11L, displacement = 1e-11L;

[[nodiscard]] Coordinates moved(const Coordinates& z, const Coordinates& rate, Real time) {
    Coordinates to = z;
    for (std::size_t k = 0; k < z.size(); ++k) to[k] += time * rate[k];
    return to;
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
            bend(pin);
            if (z_.size() == static_cast<std::size_t>(rigid_coordinates * p_.chain.pins)) continue;
            for (const Real which : {1.0L, -1.0L})
                for (int side = 0; side < 2; ++side) tip(pin, which, side);
        }
    }
    [[nodiscard]] const Coordinates& force() const { return force_; }
    [[nodiscard]] Real inertia(int k) const {
        const Real plates = p_.plate.count * Real{p_.plate.mass};
        if (k > 5) return p_.detail.mass_scaling * 8.0L * 2.0L * p_.half.mass / 5.0L;
        if (k == 5) return 0.5L * half_mass_;  // two halves that part, each by half of ζ
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
            for (int k = 0; k < rigid_coordinates; ++k) differentiate(static_cast<std::size_t>(k * pins + (near + pins) % pins));
        for (std::size_t k = static_cast<std::size_t>(rigid_coordinates * pins); k < z_.size(); ++k) differentiate(k);
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
        const Spring bow = bow_spring();
        spring(deflection(4), bow.stiffness, bow.damping, i);
        const std::array<Real, 4> before = shares(i), behind = shares(i + 1);
        for (const Real reach : {-std::sqrt(square_), std::sqrt(square_)}) {
            const Measure offset = [=, this](const Place& at) {
                return at.axial(i + 1, 1.0L) - at.axial(i, -1.0L) + reach * (lengthening(at, i + 1, behind) - lengthening(at, i, before));
            };
            rub(offset, p_.plate.friction, 0.5L * std::max(0.0L, tension_), i);
        }
    }

    /// Of a link between pins that bend differently along it: plates, whose middle moves with both, and joint in series.
    [[nodiscard]] Spring bow_spring() const {
        const Place at(p_, z_);
        const Real plates = p_.plate.count * Real{p_.plate.stiffness}, joint = p_.joint.stiffness;
        const Real share = at.mean_shape(2) - at.mean_shape() * at.mean_shape();
        return {static_cast<double>(1.0L / (1.0L / (plates * share) + 5.0L / joint)),
                static_cast<double>(damping(1.0L / (1.0L / plates + 1.0L / joint), 0.5L * half_mass_) * share)};
    }

    /// By how much a half shortens per depth of a tip at which y² (1 + b y) = δ.
    [[nodiscard]] Real shortening(Real y) const {
        return 3.0L * softness_ * y / (2.0L + 3.0L * softness_ * y) / std::cos(Real{p_.tip.angle});
    }

    /// The same of the four tips of a pin now; zero where they do not touch.
    [[nodiscard]] std::array<Real, 4> shares(int pin) const {
        std::array<Real, 4> all{};
        if (z_.size() == static_cast<std::size_t>(rigid_coordinates * p_.chain.pins)) return all;
        for (std::size_t tip = 0; tip < 4; ++tip) {
            const Real depth = Place(p_, z_).tip(pin, tip < 2 ? 1.0L : -1.0L, tip % 2).depth;
            if (depth > 0.0L) all[tip] = shortening(root_of_depth(depth, softness_));
        }
        return all;
    }

    /// What a small motion lengthens half a pin by, mean of its halves and ends.
    [[nodiscard]] static Real lengthening(const Place& at, int pin, const std::array<Real, 4>& share) {
        Real sum = 0.0L;
        for (std::size_t tip = 0; tip < 4; ++tip)
            if (share[tip] > 0.0L) sum -= 0.25L * share[tip] * at.tip(pin, tip < 2 ? 1.0L : -1.0L, tip % 2).depth;
        return sum;
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
        rub([pin](const Place& there) { return there.coordinate(5, pin); }, p_.joint.friction, pressing, pin);
    }

    /// Along the direction of travel, which is the bisector of the pitch lines, and across.
    void bend(int pin) {
        const auto along = [](const Place& at, int number) { return oracle::unit(at.line(number - 1) + at.line(number)); };
        const Real cube = std::pow(Real{p_.half.length}, 3), mass = p_.detail.mass_scaling * 8.0L * 2.0L * p_.half.mass / 5.0L;
        const Real travel = 288.0L * p_.half.bending_travel / cube, height = 288.0L * p_.half.bending_height / cube;
        spring([=](const Place& at) { return oracle::dot(at.bend(pin), along(at, pin)); }, travel, damping(travel, mass), pin);
        spring([=](const Place& at) { return oracle::cross(along(at, pin), at.bend(pin)); }, height, damping(height, mass), pin);
    }

    /// Work done against link i by a shift of its front half in the plane: its energy, with dampers pulling as they do now.
    [[nodiscard]] Real link_energy_shifted(const Place& at, int i, Vec2 shift) const {
        const Real per_half = 2.0L / p_.half.length, length = at.free_length(i);
        const Vec2 d = at.half(i + 1, 1.0L) - at.half(i, -1.0L) + shift, t = oracle::unit(d), n = oracle::left_of(t);
        const Vec2 ends = at.end(i + 1) - at.end(i), both = at.end(i + 1) + at.end(i);
        const Real rise = at.axial(i + 1, 1.0L) - at.axial(i, -1.0L), roll = oracle::dot(ends, n);
        const std::array<Real, 5> u{oracle::norm(d) - length + (square_ * roll * roll + rise * rise) / (2.0L * length),
                                    oracle::dot(ends, t), roll, -per_half * oracle::dot(both, t) - 2.0L * rise / length,
                                    oracle::dot(at.bend(i + 1) - at.bend(i), t)};
        const Spring bow = bow_spring();
        const Real plates = p_.plate.count * Real{p_.plate.stiffness}, joint = p_.joint.stiffness;
        const Real pull = 1.0L / (1.0L / plates + 1.0L / joint), bending = p_.plate.count * Real{p_.plate.bending_stiffness} / length;
        const Real torsion = p_.plate.count * Real{p_.plate.torsion_stiffness};
        const Real tilt = p_.detail.mass_scaling * 0.5L * p_.half.mass / 3.0L * std::pow(0.5L * p_.half.length, 2);
        const Real pack_yaw = 1.0L / (1.0L / (plates * square_) + 3.0L / joint), square = per_half * per_half;
        const std::array<Real, 5> k{pull, pack_yaw + square * bending, square * torsion, 3.0L * bending, bow.stiffness};
        const Real pull_damping = damping(pull, 0.5L * half_mass_);
        const std::array<Real, 5> c{pull_damping, pull_damping * square_ + square * damping(bending, tilt), square * damping(torsion, tilt),
                                    damping(3.0L * bending, tilt), bow.damping};
        Real work = 0.0L;
        for (std::size_t which = 0; which < 5; ++which) {
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
        const Real share = shortening(y);
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
        const Real law = oracle::tip_law_factor(p_, speed, y * y);
        const Real factor = p_.tip.friction.coefficient * normal * law * oracle::friction_slope(p_.detail, p_.tip.friction, speed);
        push(round, -factor * u, pin);
        push(flank, -factor * v, pin);
        lost += factor * speed * speed;
    }

    const Parameters& p_;
    Coordinates z_, rate_, before_z_, after_z_, force_, start_;
    Real square_ = 0.0L, half_mass_ = 0.0L, softness_ = 0.0L, tension_ = 0.0L;
};

}  // namespace

Parameters with_rigid_pins(Parameters p) {
    p.detail.pins = PinDetail::rigid;
    p.detail.order = 2;
    p.detail.plates = PlateDetail::lumped;
    return p;
}

PlainMotion plain_motion(const Parameters& parameters, const std::vector<double>& coordinates, const std::vector<double>& velocities,
                         const std::vector<double>& inertia) {
    Machine machine(parameters, Coordinates(coordinates.begin(), coordinates.end()), Coordinates(velocities.begin(), velocities.end()));
    machine.run();
    PlainMotion motion;
    const std::size_t pins = static_cast<std::size_t>(parameters.chain.pins);
    for (std::size_t k = 0; k < coordinates.size(); ++k) {
        const Real mass =
            k < rigid_coordinates * pins ? machine.inertia(static_cast<int>(k / pins)) : Real{inertia[k - rigid_coordinates * pins]};
        motion.acceleration.push_back(static_cast<double>(machine.force()[k] / mass));
    }
    motion.energy = static_cast<double>(machine.energy);
    motion.lost = static_cast<double>(machine.lost);
    return motion;
}

}  // namespace cvtflow::model::test
