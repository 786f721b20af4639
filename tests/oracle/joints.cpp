/// Rolling joints and plate opening (EQUATIONS.md, section 5).

#include "tests/oracle/friction.hpp"
#include "tests/oracle/legendre.hpp"
#include "tests/oracle/system.hpp"

#include <algorithm>

namespace cvtflow::oracle {

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
