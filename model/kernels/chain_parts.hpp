#pragma once
/// Contributions of one link, one joint and the tips of one link, and the accelerations of a link. A segment uses the same pieces in one
/// pass (fused) and stage by stage (bench/staged), so results are bitwise equal.

#include <cmath>
#include <cstring>

#include "model/basis/lanes.hpp"
#include "model/chain/chain_model.hpp"
#include "model/force/inner.hpp"
#include "model/force/joint.hpp"
#include "model/force/plates.hpp"
#include "model/force/tips.hpp"
#include "model/machine/link_inertia.hpp"

namespace cvtflow::model {
namespace {

/// Calls body with the smallest compiled lane count that holds `width`.
template <class Body>
inline void with_lanes(int width, const Body& body) noexcept {
    if (width == 1) return body.template operator()<1>();
    if (width == 2) return body.template operator()<2>();
    if (width <= 4) return body.template operator()<4>();
    if (width <= 8) return body.template operator()<8>();
    return body.template operator()<16>();
}

[[nodiscard]] inline bool any_touching(const Phase* phases) noexcept { return phase_word(phases) != 0; }

/// Elasticity and plates of a link. Clears and fills its generalized forces f; returns the moment about z on it. state [unknowns of the
/// link], f [N, N·m]
template <int P, bool Observe>
[[nodiscard]] inline double link_part(const Coefficients& c, int link, const LinkFrame& frame, const double* state, double* f,
                                      Account* account) noexcept {
    const double* v = state + link_layout<P>.link_size();
    std::memset(f, 0, static_cast<std::size_t>(link_layout<P>.link_size()) * sizeof(double));
    const LinkKind& kind = c.kind(link);
    const double moment = inner_elasticity<P, Observe>(c, kind, frame, state, v, f, account);
    if (!c.longer.empty()) add_lengths<P, Observe, double>(c, lengths_at(c, link), state, f, account);
    with_lanes(c.plates.width, [&]<int W>() { plates<P, W, Observe>(c, kind, state, v, f, account); });
    return moment;
}

/// Sum of the plates' elastic tensions, of one link or of several side by side.
template <int P, class Kind, class Real>
[[nodiscard]] inline Real elastic_tension(const Coefficients& c, const Kind& kind, const Real* q) noexcept {
    using std::sqrt;
    const Difference<P, Real> d(q, End::front, q, End::rear);
    Real tension(0.0);
    for (std::size_t j = 0; j < static_cast<std::size_t>(c.plates.count); ++j) {
        Real dx(0.0), dy(0.0);
        for (int m = 0; m <= P; ++m) {
            dx += d.x[m] * c.plates.basis[static_cast<std::size_t>(m)][j];
            dy += d.y[m] * c.plates.basis[static_cast<std::size_t>(m)][j];
        }
        const Real dz = d.z + c.plates.position[j] * d.e;
        tension += c.plates.weight[j] * (sqrt(dx * dx + dy * dy + dz * dz) - kind.free_length);
    }
    return tension;
}

/// Joint between two links with their states and frames. state_before [states of a link]
template <int P, bool Observe>
inline void joint_part(const Coefficients& c, const LinkFrame& before, const LinkFrame& after, const double* state_before,
                       const double* state_after, JointForce<P>& out, Account* account) noexcept {
    constexpr int size = link_layout<P>.link_size();
    out = {};
    with_lanes(c.joint_points.width, [&]<int W>() {
        joint<P, W, Observe>(c, before, after, state_before, state_before + size, state_after, state_after + size, out, account);
    });
}

/// Replaces `blocks` vectors of N numbers, N apart, by their products with the inverse: its columns times the vector's numbers, summed in
/// their order. Each column is loaded once for all blocks.
template <int N, int blocks>
inline void multiply(const SmallInverse& inverse, double* f) noexcept {
    constexpr int width = padded(N);
    std::array<Lanes<width>, blocks> total;
    for (int k = 0; k < N; ++k) {
        const auto column = load<width>(inverse.column.data() + k * width);
        for (std::size_t block = 0; block < blocks; ++block) {
            const auto term = f[static_cast<int>(block) * N + k] * column;
            total[block] = k == 0 ? term : total[block] + term;
        }
    }
    for (std::size_t block = 0; block < blocks; ++block) {
        alignas(64) double buffer[width];
        total[block].copy_to(buffer);
        std::memcpy(f + block * N, buffer, N * sizeof(double));
    }
}

/// Accelerations of a link from its generalized forces, in place. f [in: N, N·m; out: m/s², rad/s²]
template <int P>
inline void accelerate(const LinkInertia& inertia, double* f) noexcept {
    multiply<2 * (P + 1), 2>(inertia.lateral, f);
    multiply<4, 1>(inertia.axial, f + 4 * (P + 1));
}

/// Forces of the tips of one link, kept apart until they are added.
template <int P>
struct TipShare {
    double force[4 * (P + 1) + 4];
    double moment;  ///< about z [N·m]
};

/// Force of tips on their sheaves along z.
template <class Geometry, class Tips>
[[nodiscard]] inline Tips axial_force(const Geometry& geometry, const TipForces<Tips>& forces) noexcept {
    return -(forces.normal * geometry.normal.z + forces.friction.z);
}

/// Writes what the tips of a link carry. @param shaft_x place of the shaft's axis [m]
template <class Geometry>
inline void note_contact(double shaft_x, const Geometry& geometry, const TipMotion<TipLanes>& motion, const TipForces<TipLanes>& forces,
                         LinkContact& contact) noexcept {
    geometry.depth.copy_to(contact.depth);
    forces.normal.copy_to(contact.normal);
    axial_force(geometry, forces).copy_to(contact.axial);
    const TipLanes x = geometry.end.x + motion.lever_x - shaft_x, y = geometry.end.y + motion.lever_y, radius = sqrt(x * x + y * y);
    const TipLanes push_x = -(forces.normal * geometry.normal.x + forces.friction.x),
                   push_y = -(forces.normal * geometry.normal.y + forces.friction.y);
    TipLanes((x * push_y - y * push_x) / radius).copy_to(contact.tangential);
    TipLanes((x * push_x + y * push_y) / radius).copy_to(contact.radial);
    radius.copy_to(contact.radius);
    const Vector3<TipLanes> slip = tangential(motion.material, geometry.normal);
    const TipLanes square = dot(slip, slip), power = -dot(forces.friction, motion.material);
    sqrt(square).copy_to(contact.sliding);
    power.copy_to(contact.power);
    const TipLanes grip = power / larger<tips_per_link>(square, TipLanes(1e-300));
    const auto& arm = motion.sheave_arm;
    const TipLanes arm_square = arm.x * arm.x + arm.y * arm.y, around = arm.x * slip.y - arm.y * slip.x;
    TipLanes(grip * arm_square).copy_to(contact.hold);
    TipLanes(grip * around).copy_to(contact.drag);
    TipLanes(grip * around * around / arm_square).copy_to(contact.creep_power);
}

/// Tips of a link that touches somewhere; reactions on its sheaves to `load`. state [unknowns of the link]
/// @param contact what the tips carry, if observed; else nullptr
template <int P, bool Observe>
inline void tip_part(const ChainModel& model, const LinkFrame& frame, const double* state, const SheaveMotion* sheaves, const Phase* phases,
                     TipShare<P>& share, LinkLoad& load, Account* account, LinkContact* contact = nullptr) noexcept {
    std::memset(share.force, 0, sizeof share.force);
    load.shaft = model.shaft_of(state);
    const double shaft_x = load.shaft * model.coefficients().centre_distance;
    const auto seen = [=, &load](const auto& geometry, const auto& motion, const auto& forces) {
        if (contact == nullptr) return;
        note_contact(shaft_x, geometry, motion, forces, *contact);
        contact->shaft = load.shaft;
    };
    share.moment = tips<P, Observe>(model.coefficients(), frame, state, state + link_layout<P>.link_size(), sheaves + 2 * load.shaft,
                                    phases, share.force, load.load, account, seen);
}

/// Adds joints and tips (none: nullptr) to what link_part left in f. The order of the sums is part of the promise of equal bits. moment
/// [N·m]
template <int P>
inline void assemble(const LinkFrame& frame, double moment, const JointForce<P>& rear, const JointForce<P>& front, const TipShare<P>* tips,
                     double* f) noexcept {
    rear.on_front.apply(-1.0, f, End::rear);
    front.on_front.apply(1.0, f, End::front);
    moment += rear.after + front.before;
    if (tips != nullptr) {
        for (int k = 0; k < link_layout<P>.link_size(); ++k) f[k] += tips->force[k];
        moment += tips->moment;
    }
    add_moment<P>(frame, moment, f);
}

}  // namespace
}  // namespace cvtflow::model
