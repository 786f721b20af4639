#pragma once
/// A chain of rigid pins: pitch lines, halves that roll by constraint, tips, and the forces while they are added up
/// (EQUATIONS.md, sections 10 and 11).

#include "tests/oracle/system.hpp"

#include <span>
#include <vector>

namespace cvtflow::oracle {

/// Numbers of every pin and link.
struct PinNumbers {
    Real square = 0.0L;       ///< ξ̂², mean square of the plates' places
    Real bow = 0.0L;          ///< κ, mean of P_2 over the plates
    Real bow_square = 0.0L;   ///< s², mean square of P_2 against its mean, over (1 - κ)²
    Real mass = 0.0L;         ///< m, inertia of x, y, z [kg]
    Real tilt_mass = 0.0L;    ///< m_D [kg]
    Real bend_mass = 0.0L;    ///< m_B [kg]
    Real softness = 0.0L;     ///< b = K cos²β/k_e, yielding of half a pin along its axis in series with a tip [1/√m]
    Real end_slope = 0.0L;    ///< slope at an end per displacement D, 2/ℓ_p [1/m]
    Real bend_factor = 0.0L;  ///< q: slope at an end by bending over that by tilting, for equal displacements
};
PinNumbers pin_numbers(const model::Parameters& parameters);

/// Line from pin i to pin i + 1.
struct PitchLine {
    Vec2 t, n, o;         ///< direction, left normal, outward normal
    Real length = 0.0L;   ///< ℓ [m]
    Real turning = 0.0L;  ///< θ' [rad/s]
};

/// Rolling of the halves of a pin on each other.
struct Rolling {
    Vec2 bisector;             ///< b
    Real along, across;        ///< A = along 1 - across b bᵀ
    Vec2 offset, offset_rate;  ///< u, u' of the front half against the rear half [m], [m/s]

    [[nodiscard]] Vec2 times(Vec2 f) const { return along * f - (across * dot(bisector, f)) * bisector; }  ///< A f
};

/// Middle of a half of a pin, which turns with a pitch line.
struct PinHalf {
    int pin, line;
    Real sign;  ///< +1: the front half, ahead of the pin's middle; -1: the rear half
    Vec2 at, rate;
    Real z, z_rate;
};

/// A chain of rigid pins: where everything is and how it moves.
struct PinChain {
    explicit PinChain(const System& system);

    const System& system;
    PinNumbers numbers;
    std::vector<PitchLine> line;   ///< i: line from pin i to pin i + 1
    std::vector<Rolling> rolling;  ///< [pins] rolling of each pin's halves

    [[nodiscard]] const RigidPin& pin(int i) const { return system.pins[system.layout.wrapped(i)]; }
    /// The front half of pin i belongs to link i - 1, its rear half to link i.
    [[nodiscard]] PinHalf half(int i, model::End end) const;
    [[nodiscard]] TipContact tip(const PinHalf& half, int side) const;
    [[nodiscard]] Vec2 end_slope(int i, Real s) const;  ///< σ_s of a pin
};

/// Coordinates and velocities of all pins.
std::vector<RigidPin> unpack_pins(const model::Parameters& parameters, const model::ChainLayout& layout, std::span<const Real> state);
/// Forces on a pin in the order of a block's q [N].
std::vector<Real> pin_forces(const System& system, const RigidPinForce& force);
/// Inertia of a pin in the same order [kg].
std::vector<Real> pin_inertia(const System& system);

struct PinForces {
    PinForces(const PinChain& chain, Totals& totals);

    const PinChain& chain;
    Totals& totals;
    std::vector<Real> moment;   ///< moments on pitch lines [N·m]
    std::vector<Real> thrust;   ///< Λ of plates' friction on the lengthening e of each pin [N]
    std::vector<Real> tension;  ///< T of each link [N]
    std::vector<Vec2> pull;     ///< f_i: of link i's deflections on its front half [N]

    /// A force on the middle of a half: virtual work on its pin's middle and on the directions on which the offset of the halves depends.
    void push(const PinHalf& half, Vec2 force, Real axial);
    void turn_lines();  ///< passes the moments to the pins
};

/// A tip that touches, with quantities of its place and motion alone.
struct PinTip {
    PinHalf half;
    TipContact contact;
    Real depth_rate;  ///< δ_0' [m/s]
    Real root;        ///< y, root of the depth that is Hertz's [√m]
    Real shortening;  ///< η: of half a pin, per depth
};
std::vector<PinTip> pressed_tips(const PinChain& chain);
/// e' of each pin [m/s].
std::vector<Real> lengthening_of(const PinChain& chain, const std::vector<PinTip>& tips);
void add_pin_tip(PinForces& forces, const PinTip& tip);

}  // namespace cvtflow::oracle
