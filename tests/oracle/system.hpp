#pragma once
/// The state vector unpacked into halves, links and pulley bodies, and the forces on them (EQUATIONS.md, section 1).

#include "tests/oracle/plain_rhs.hpp"

#include <array>
#include <span>
#include <vector>

namespace cvtflow::oracle {

/// One half of a pin: curve coordinates (x_m, y_m), axial z and e, and their rates.
struct Half {
    Real length = 0.0L;            ///< ℓ_p [m]
    std::vector<Vec2> shape;       ///< (x_m, y_m), m = 0…p [m]
    std::vector<Vec2> shape_rate;  ///< [m/s]
    Real z = 0.0L, e = 0.0L, z_rate = 0.0L, e_rate = 0.0L;

    [[nodiscard]] int order() const { return static_cast<int>(shape.size()) - 1; }
    [[nodiscard]] Vec2 at(Real xi) const;             ///< (X, Y) at ξ [m]
    [[nodiscard]] Vec2 rate_at(Real xi) const;        ///< [m/s]
    [[nodiscard]] Vec2 slope_at(Real xi) const;       ///< d(X, Y)/dz at ξ [1]
    [[nodiscard]] Vec2 slope_rate_at(Real xi) const;  ///< [1/s]
    [[nodiscard]] Vec2 mean_slope() const;            ///< σ = (2/ℓ_p)(x_1, y_1), zero if p = 0
    [[nodiscard]] Vec2 mean_slope_rate() const;
};

/// Link i: rear half R_i and front half L_{i+1}, with the frame of the m = 0 coordinates.
struct Link {
    Half rear, front;
    Vec2 t, n, o;             ///< travel, left normal, outward normal
    Real length = 0.0L;       ///< ℓ = |X_b0 - X_a0| [m]
    Real turning = 0.0L;      ///< θ' [rad/s]
    Real rest_length = 0.0L;  ///< ℓ_0 = P_i + w [m]

    [[nodiscard]] const Half& half(model::End end) const { return end == model::End::rear ? rear : front; }
};

/// Generalized forces on one half.
struct HalfForce {
    std::vector<Vec2> shape;  ///< forces on (x_m, y_m) [N]
    Real z = 0.0L, e = 0.0L;  ///< [N]

    void push(Real xi, Vec3 force);  ///< a force [N] at the point ξ of the axis
};

struct LinkForce {
    HalfForce rear, front;

    [[nodiscard]] HalfForce& half(model::End end) { return end == model::End::rear ? rear : front; }
    void turn(const Link& link, Real moment);  ///< a moment about z [N·m]
};

/// A pin as one body (section 11): middle Q of its plates, displacement D of the end at +z and B of both ends by bending, z of the middle
/// and ζ by which the front half is ahead of the rear half; and rates.
struct RigidPin {
    Vec2 middle, end, bend, middle_rate, end_rate, bend_rate;
    Real z = 0.0L, slide = 0.0L, z_rate = 0.0L, slide_rate = 0.0L;
};

/// Generalized forces on one of them [N].
struct RigidPinForce {
    Vec2 middle, end, bend;
    Real z = 0.0L, slide = 0.0L;
};

/// A shaft or sheave: small displacement (u_x, u_y, w), small tilt (τ_x, τ_y), turning φ; and rates.
struct Body {
    Vec2 u, tau, u_rate, tau_rate;
    Real w = 0.0L, phi = 0.0L, w_rate = 0.0L, phi_rate = 0.0L;
};

struct BodyForce {
    Vec3 force;   ///< force on u_x, u_y, w [N]
    Vec3 moment;  ///< moment on τ_x, τ_y, φ [N·m]
};

inline constexpr int bodies = 6;

struct System {
    const model::Parameters& parameters;
    model::ChainLayout layout;
    double t;  ///< [s]
    std::vector<Link> links;
    std::array<Body, bodies> body;  ///< rigid pulleys: sheaves (0, 0, 0, 0, w, φ_k), shafts (0, 0, 0, 0, 0, φ_k)
    Real control_integral[2] = {};  ///< I of both controllers [s]
    std::span<const model::Phase> phases;
    const FarEnds* far = nullptr;  ///< ends of couplings that have taken over, and with them hydraulics
    std::array<Real, model::hydraulic_unknowns> oil{};
    std::vector<RigidPin> pins{};  ///< pins of a chain of rigid pins, which has no links
    std::vector<Real> longer{};    ///< λ of each pin; empty: all are equal [m]

    [[nodiscard]] Real longer_half(int pin) const { return longer.empty() ? 0.0L : longer[static_cast<std::size_t>(layout.wrapped(pin))]; }
    [[nodiscard]] int controllers() const { return layout.controls % model::hydraulic_unknowns; }
};

/// Sums of all force laws.
struct Totals {
    std::vector<LinkForce> link;
    std::vector<RigidPinForce> pin;
    std::array<BodyForce, bodies> body;
    PowersOf<Real> powers;
    EnergiesOf<Real> energies;
    Real control_rate[2 + model::hydraulic_unknowns] = {};  ///< I' [1], then those of the hydraulics

    [[nodiscard]] Real& loss(model::Loss kind) { return powers.losses[static_cast<std::size_t>(kind)]; }
    [[nodiscard]] Real& work(model::Work kind) { return powers.works[static_cast<std::size_t>(kind)]; }
};

System unpack(const model::Parameters& parameters, double t, std::span<const Real> state, std::span<const model::Phase> phases);
Totals empty_totals(const System& system);
/// All generalized forces in the order of q.
std::vector<Real> pack_forces(const System& system, const Totals& totals);

/// One plate of a link, or one lumped plate.
struct PlateSpring {
    Real xi;         ///< position along the halves, ξ_j
    Real mass;       ///< [kg]
    Real stiffness;  ///< [N/m]
    Real damping;    ///< [N·s/m]
};
std::vector<PlateSpring> plate_springs(const model::Parameters& parameters);
/// ξ_j of every plate of a link, also of a lumped pack.
std::vector<Real> plate_places(const model::Parameters& parameters);
/// m_c, the mass seen by a spring of the chain [kg].
Real spring_mass(const model::Parameters& parameters);
/// 2 ζ sqrt(k m) [N·s/m].
Real damping_of(Real ratio, Real stiffness, Real mass);

Half unpack_half(const model::Parameters& parameters, const model::ChainLayout& layout, model::End end, std::span<const Real> block);
void make_frame(Link& link);  ///< sets the frame from the halves

/// Travel of a movable sheave toward the chain [m].
Real travel(const System& system, int shaft);
/// Force of spring and rotating oil behind a piston [N].
Real force_without_pressure(const System& system, int shaft);
/// Clamping forces by pressure [N], with the rates of the hydraulics in `totals`. requested [N]
std::array<Real, 2> hydraulic_forces(const System& system, const std::array<Real, 2>& requested, Totals& totals);

// The force laws, section by section.
void add_inner_elements(const System& system, Totals& totals);  // 3
void add_plates(const System& system, Totals& totals);          // 4
void add_joints(const System& system, Totals& totals);          // 5
void add_tips(const System& system, Totals& totals);            // 6
void add_rigid_pins(const System& system, Totals& totals);      // 11: instead of 3 to 6
void add_supports(const System& system, Totals& totals);        // 8: bearings and attachments
void add_gyroscopic(const System& system, Totals& totals);      // 8
void add_guides(const System& system, Totals& totals);          // 8: of the strands
void add_inputs(const System& system, Totals& totals);          // 8: drive, load, clamping, cylinder, control

/// Accelerations of all coordinates from the generalized forces (section 2).
std::vector<Real> accelerations(const System& system, std::span<const Real> forces);
Real kinetic_energy(const System& system, std::span<const Real> state);

/// Shaft (0 driving, 1 driven) to which a link belongs.
int shaft_of(const System& system, const Link& link);

/// Offset of the flank of a sheave from its body if it is imperfect: eccentric by its run-out, which turns with it, and pulley 2 beside
/// its place [m]; and its rate [m/s].
Vec3 flank_offset(const System& system, int shaft, int side);
Vec3 flank_rate(const System& system, int shaft, int side);

/// Position of one tip, and its contact with its sheave.
struct TipContact {
    int shaft, side, sheave;  ///< numbers: 0/1, 0/1 (-z/+z), body
    Real s;                   ///< side as a sign
    Vec3 end;                 ///< E [m]
    Vec3 centre;              ///< S [m]
    Vec3 centre_turning;      ///< ∂S/∂θ [m]
    Vec3 r;                   ///< S - O [m]
    Vec3 local_normal;        ///< ν
    Vec3 normal;              ///< G
    Real depth;               ///< δ [m]
};
/// Origin of a sheave's flank [m], and its velocity [m/s].
Vec3 flank_origin(const System& system, int shaft, int side);
Vec3 origin_rate(const System& system, const TipContact& contact);
/// χ of a tip's normal force [s/m].
Real tip_damping(const model::Parameters& parameters);
/// Reactions on a sheave: of a normal force along the gradient of the depth, and of friction f [N].
void press_sheave(const System& system, const TipContact& contact, Real force, Totals& totals);
void rub_sheave(const System& system, const TipContact& contact, Vec3 f, Totals& totals);
TipContact tip_contact(const System& system, const Link& link, model::End end, int side);
/// Velocity of a tip against its sheave at the contact point: v and v_t [m/s].
struct TipSliding {
    Vec3 whole;
    Vec3 tangential;
};
TipSliding tip_sliding(const System& system, const Link& link, model::End end, const TipContact& contact);

}  // namespace cvtflow::oracle
