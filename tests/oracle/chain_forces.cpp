/// Forces inside the chain: elastic elements of halves and plate packs, plates, rolling joints and plate opening (EQUATIONS.md, sections 3
/// to 5).

#include "tests/oracle/friction.hpp"
#include "tests/oracle/legendre.hpp"
#include "tests/oracle/system.hpp"

#include <algorithm>

namespace cvtflow::oracle {

Real damping_of(Real ratio, Real stiffness, Real mass) { return 2.0L * ratio * std::sqrt(stiffness * mass); }

Real spring_mass(const model::Parameters& parameters) {
    const Real plates = parameters.plate.count * Real{parameters.plate.mass};
    return 0.5L * (parameters.half.mass + 0.5L * plates);
}

std::vector<Real> plate_places(const model::Parameters& parameters) {
    const int n = parameters.plate.count;
    std::vector<Real> places;
    for (int j = 0; j < n; ++j) {
        const Real along = n == 1 ? 0.0L : 2.0L * j / (n - 1) - 1.0L;
        places.push_back(2.0L / parameters.half.length * parameters.plate.span * along);
    }
    return places;
}

std::vector<PlateSpring> plate_springs(const model::Parameters& parameters) {
    const auto& plate = parameters.plate;
    const int n = plate.count;
    std::vector<Real> places = plate_places(parameters);
    if (parameters.detail.plates == model::PlateDetail::lumped) {
        Real mean_square = 0.0L;
        for (const Real xi : places) mean_square += xi * xi / n;
        const Real radius = std::sqrt(mean_square);
        places = {-radius, radius};
    }
    const Real springs = static_cast<Real>(places.size());
    const Real stiffness = n * Real{plate.stiffness};
    const Real damping = damping_of(parameters.chain.damping_ratio, stiffness, spring_mass(parameters));
    std::vector<PlateSpring> result;
    for (const Real xi : places) result.push_back({xi, n * Real{plate.mass} / springs, stiffness / springs, damping / springs});
    return result;
}

namespace {

/// A spring with a viscous partner: books energy and loss, returns k u + c u'.
Real spring(Real u, Real rate, Real stiffness, Real damping, Real& energy, Real& loss) {
    energy += 0.5L * stiffness * u * u;
    loss += damping * rate * rate;
    return stiffness * u + damping * rate;
}

/// Extension of a half against its length.
void add_extension(const System& system, int pin, const Half& half, HalfForce& force, Totals& totals) {
    const auto& p = system.parameters;
    const Real k = 4.0L * p.chain.young_modulus * p.half.area / p.half.length;
    const Real c = damping_of(p.chain.damping_ratio, k, Real{p.half.mass} / 3.0L);
    force.e -= spring(half.e - system.longer_half(pin), half.e_rate, k, c, totals.energies.inner, totals.loss(model::Loss::inner));
}

/// Bending shape m = 2 or 3 of a half along `direction`, whose derivative with the link's turning is `turned`.
void add_half_bending(const System& system, int number, model::End end, int m, Vec2 direction, Vec2 turned, Real rigidity, Totals& totals) {
    const auto& p = system.parameters;
    const Link& link = system.links[number];
    const Half& half = link.half(end);
    const Real length = p.half.length;
    const Real k = (m == 2 ? 144.0L : 1200.0L) * rigidity / (length * length * length);
    const Real c = damping_of(p.chain.damping_ratio, k, Real{p.half.mass} / (2.0L * m + 1.0L));
    const Real u_turned = dot(half.shape[m], turned);
    const Real u = dot(half.shape[m], direction);
    const Real rate = dot(half.shape_rate[m], direction) + link.turning * u_turned;
    const Real f = spring(u, rate, k, c, totals.energies.inner, totals.loss(model::Loss::inner));
    totals.link[number].half(end).shape[m] += -f * direction;
    totals.link[number].turn(link, -f * u_turned);
}

/// u = (rear σ_a + front σ_b)·direction + axial (z_b - z_a).
struct PackDeflection {
    Real rear, front;  ///< factors of the slopes
    Vec2 direction, turned;
    Real axial;
    Real stiffness, mass;
};

void add_pack(const System& system, int number, const PackDeflection& d, Totals& totals) {
    const Link& link = system.links[number];
    const Vec2 slopes = d.rear * link.rear.mean_slope() + d.front * link.front.mean_slope();
    const Vec2 slope_rates = d.rear * link.rear.mean_slope_rate() + d.front * link.front.mean_slope_rate();
    const Real u_turned = dot(slopes, d.turned);
    const Real u = dot(slopes, d.direction) + d.axial * (link.front.z - link.rear.z);
    const Real rate = dot(slope_rates, d.direction) + link.turning * u_turned + d.axial * (link.front.z_rate - link.rear.z_rate);
    const Real c = damping_of(system.parameters.chain.damping_ratio, d.stiffness, d.mass);
    const Real f = spring(u, rate, d.stiffness, c, totals.energies.pack, totals.loss(model::Loss::inner));
    LinkForce& force = totals.link[number];
    const Real per_slope = 2.0L / system.parameters.half.length;
    force.rear.shape[1] += (-f * d.rear * per_slope) * d.direction;
    force.front.shape[1] += (-f * d.front * per_slope) * d.direction;
    force.front.z -= f * d.axial;
    force.rear.z += f * d.axial;
    force.turn(link, -f * u_turned);
}

void add_plate_pack(const System& system, int number, Totals& totals) {
    const auto& p = system.parameters;
    const Link& link = system.links[number];
    const Vec2 t = link.t;
    const Vec2 n = link.n;
    const Real rest = link.rest_length;
    const Real bending = p.plate.bending_stiffness * p.plate.count;
    const Real torsion = p.plate.torsion_stiffness * p.plate.count;
    const Real half_length = p.half.length / 2.0L;
    const Real swing = 0.5L * (p.half.mass / 3.0L) * half_length * half_length;
    // θ = -σ·t turns into -σ·n, σ·n into -σ·t.
    add_pack(system, number, {1.0L, -1.0L, t, n, 0.0L, bending / rest, swing}, totals);
    add_pack(system, number, {-1.0L, -1.0L, t, n, -2.0L / rest, 3.0L * bending / rest, swing}, totals);
    add_pack(system, number, {-1.0L, 1.0L, n, -t, 0.0L, torsion, swing}, totals);
}

void add_plate(const System& system, int number, const PlateSpring& plate, Totals& totals) {
    const Link& link = system.links[number];
    const Half& a = link.rear;
    const Half& b = link.front;
    const Vec3 d = in_space(b.at(plate.xi) - a.at(plate.xi), b.z - a.z + plate.xi * (b.e - a.e));
    const Vec3 d_rate = in_space(b.rate_at(plate.xi) - a.rate_at(plate.xi), b.z_rate - a.z_rate + plate.xi * (b.e_rate - a.e_rate));
    const Real length = norm(d);
    const Real rate = dot(d, d_rate) / length;
    const Real stretch = length - link.rest_length;
    Real& loss = totals.loss(model::Loss::plate_damping);
    const Real tension = spring(stretch, rate, plate.stiffness, plate.damping, totals.energies.plates, loss);
    const auto& friction = system.parameters.plate.friction;
    const Real slope = friction_slope(system.parameters.detail, friction, std::abs(d_rate.z));
    const Real sliding = friction.coefficient * std::max(tension, 0.0L) * slope * d_rate.z;
    totals.loss(model::Loss::plate_friction) += sliding * d_rate.z;
    const Vec3 on_front = (-tension / length) * d - Vec3{0.0L, 0.0L, sliding};
    totals.link[number].front.push(plate.xi, on_front);
    totals.link[number].rear.push(plate.xi, -on_front);
}

}  // namespace

void add_inner_elements(const System& system, Totals& totals) {
    const auto& half = system.parameters.half;
    for (int i = 0; i < system.layout.links; ++i) {
        const Link& link = system.links[i];
        for (const model::End end : {model::End::rear, model::End::front}) {
            add_extension(system, i + static_cast<int>(end), link.half(end), totals.link[i].half(end), totals);
            for (int m = 2; m < system.layout.lateral(); ++m) {
                add_half_bending(system, i, end, m, link.t, link.n, half.bending_travel, totals);
                add_half_bending(system, i, end, m, link.n, -link.t, half.bending_height, totals);
            }
        }
        add_plate_pack(system, i, totals);
    }
}

void add_plates(const System& system, Totals& totals) {
    for (int i = 0; i < system.layout.links; ++i) {
        for (const PlateSpring& plate : plate_springs(system.parameters)) add_plate(system, i, plate, totals);
    }
}

namespace {

/// Both halves of a pin at one integration point.
struct JointPoint {
    const Link& before;  ///< link i-1, whose front half is L
    const Link& after;   ///< link i, whose rear half is R
    LinkForce& on_before;
    LinkForce& on_after;
    Real xi, weight;
    Vec2 left, right, left_rate, right_rate;  ///< X_L, X_R and rates
    Vec2 left_centre, right_centre;           ///< C_L, C_R
    Vec2 delta, delta_rate;                   ///< Δ, Δ'
};

JointPoint joint_point(const System& system, Totals& totals, int pin, const QuadraturePoint& point) {
    const int previous = system.layout.previous(pin);
    JointPoint j{system.links[previous],
                 system.links[pin],
                 totals.link[previous],
                 totals.link[pin],
                 point.at,
                 point.weight,
                 {},
                 {},
                 {},
                 {},
                 {},
                 {},
                 {},
                 {}};
    const Real arm = Real{system.parameters.joint.radius} - system.parameters.half.width / 2.0L;
    j.left = j.before.front.at(j.xi);
    j.right = j.after.rear.at(j.xi);
    j.left_rate = j.before.front.rate_at(j.xi);
    j.right_rate = j.after.rear.rate_at(j.xi);
    j.left_centre = j.left + arm * j.before.t;
    j.right_centre = j.right - arm * j.after.t;
    j.delta = j.left_centre - j.right_centre;
    const Vec2 left_centre_rate = j.left_rate + (arm * j.before.turning) * left_of(j.before.t);
    const Vec2 right_centre_rate = j.right_rate - (arm * j.after.turning) * left_of(j.after.t);
    j.delta_rate = left_centre_rate - right_centre_rate;
    return j;
}

/// A force on L (and its opposite on R): plane part through the given points of both halves' bodies, axial part at the axis.
void push_apart(const JointPoint& j, Vec3 on_left, Vec2 left_point, Vec2 right_point) {
    const Vec2 plane = in_plane(on_left);
    j.on_before.front.push(j.xi, on_left);
    j.on_after.rear.push(j.xi, -on_left);
    j.on_before.turn(j.before, cross(left_point - j.left, plane));
    j.on_after.turn(j.after, -cross(right_point - j.right, plane));
}

/// N_e and the energy stored at a depth.
struct ElasticContact {
    Real force = 0.0L;
    Real energy = 0.0L;
};

ElasticContact joint_contact(const model::Joint& joint, Real weight, Real depth) {
    if (depth <= 0.0L) return {};
    const Real k = joint.stiffness * weight;
    if (joint.law == model::JointLaw::linear) return {k * depth, 0.5L * k * depth * depth};
    const Real reference = joint.reference_depth;
    const Real force = k * reference * std::pow(depth / reference, 10.0L / 9.0L);
    return {force, 9.0L / 19.0L * force * depth};
}

void add_contact(const System& system, const JointPoint& j, Totals& totals) {
    const auto& joint = system.parameters.joint;
    const Real distance = norm(j.delta);
    const Vec2 normal = unit(j.delta);
    const Real depth = 2.0L * joint.radius - distance;
    const Real depth_rate = -dot(normal, j.delta_rate);
    const ElasticContact elastic = joint_contact(joint, j.weight, depth);
    const Real mass = spring_mass(system.parameters);
    const Real chi = 2.0L * system.parameters.chain.damping_ratio * std::sqrt(mass / joint.stiffness) / joint.reference_depth;
    const Real force = std::max(0.0L, elastic.force * (1.0L + chi * depth_rate));
    push_apart(j, in_space(force * normal, 0.0L), j.left_centre, j.right_centre);
    totals.energies.joints += elastic.energy;
    totals.loss(model::Loss::joint_damping) += (force - elastic.force) * depth_rate;

    const Vec2 contact = j.right_centre + (distance / 2.0L) * normal;
    const Vec2 left_velocity = j.left_rate + j.before.turning * left_of(contact - j.left);
    const Vec2 right_velocity = j.right_rate + j.after.turning * left_of(contact - j.right);
    const Half& left = j.before.front;
    const Half& right = j.after.rear;
    const Real along = dot(left_velocity - right_velocity, left_of(normal));
    const Real axial = left.z_rate - right.z_rate + j.xi * (left.e_rate - right.e_rate);
    const Real speed = std::sqrt(along * along + axial * axial);
    const Real factor = joint.friction.coefficient * force * friction_slope(system.parameters.detail, joint.friction, speed);
    push_apart(j, -factor * in_space(along * left_of(normal), axial), contact, contact);
    totals.loss(model::Loss::joint_friction) += factor * speed * speed;
}

void add_opening(const System& system, const JointPoint& j, Totals& totals) {
    const auto& joint = system.parameters.joint;
    const Vec2 b = unit(j.before.t + j.after.t);
    const Vec2 across = left_of(b);
    const Real turning = (j.before.turning + j.after.turning) / 2.0L;
    const Real u = dot(j.delta, across);
    const Real rate = dot(j.delta_rate, across) - dot(j.delta, b) * turning;
    const Real clearance = joint.clearance;
    const Real beyond = u - std::clamp(u, -clearance, clearance);
    const Real k = j.weight * joint.clearance_stiffness;
    const Real mass = spring_mass(system.parameters);
    const Real chi = 2.0L * system.parameters.chain.damping_ratio * std::sqrt(mass / joint.clearance_stiffness) / clearance;
    const Real sign = u > 0.0L ? 1.0L : -1.0L;
    const Real force = k * beyond * std::max(0.0L, 1.0L + chi * sign * rate);
    totals.energies.joints += 0.5L * k * beyond * beyond;
    totals.loss(model::Loss::joint_damping) += (force - k * beyond) * rate;

    const Real arm = joint.radius - system.parameters.half.width / 2.0L;
    j.on_before.front.push(j.xi, in_space(-force * across, 0.0L));
    j.on_after.rear.push(j.xi, in_space(force * across, 0.0L));
    // ∂u/∂θ of either link: the arc centre swings about the axis, and the bisector turns by half.
    j.on_before.turn(j.before, -force * (arm * dot(left_of(j.before.t), across) - dot(j.delta, b) / 2.0L));
    j.on_after.turn(j.after, -force * (arm * dot(left_of(j.after.t), across) - dot(j.delta, b) / 2.0L));
}

}  // namespace

void add_joints(const System& system, Totals& totals) {
    const auto points = gauss_legendre(system.parameters.detail.joint_points);
    for (int pin = 0; pin < system.layout.links; ++pin) {
        for (const QuadraturePoint& point : points) {
            const JointPoint j = joint_point(system, totals, pin, point);
            add_contact(system, j, totals);
            add_opening(system, j, totals);
        }
    }
}

}  // namespace cvtflow::oracle
