#pragma once
/// The loops over rigid pins: one set of functions per instruction set, with the same bits for all. (model/EQUATIONS.md section 11)

#include <array>
#include <cstddef>

#include "model/basis/isa.hpp"
#include "model/force/account.hpp"
#include "model/force/pulley.hpp"
#include "model/rigid/rigid_coefficients.hpp"

namespace cvtflow::model {

/// β of the waves' inertia κ = β h² k. A quarter is the trapezoidal rule, with which a wave is stable for itself at any step; a third
/// leaves h ω at most √3 of 2, and room for what κ leaves out: halves that roll, and friction.
inline constexpr double wave_share = 1.0 / 3.0;

/// Step of the implicit friction [s]; zero: friction of the velocities as they are.
struct RigidKick {
    double step = 0.0;
    [[nodiscard]] constexpr bool implicit() const noexcept { return step > 0.0; }
};

/// Reactions on the sheaves, extreme depths and radii (for faults).
struct RigidReaction {
    SheaveForces sheaves{};
    double deepest = -1e300;    ///< depth of a tip [m]
    double innermost = 1e300;   ///< radius of a pin, to 0.1 mm [m]
    double outermost = -1e300;  ///< radius of a pin that touches, to 0.1 mm [m]
};

/// Sums for an observation. Pairs: of pins at the driving and the driven shaft, or of links in the strand at y ≥ 0 and at y < 0.
struct RigidSums {
    double speed = 0.0;                    ///< of all pins' middles in their plane [m/s]
    std::array<double, 2> radius{};        ///< of the pins between sheaves, about the shaft's axis [m]
    std::array<double, 2> turning{};       ///< their angular speeds about it [rad/s]
    std::array<double, 2> pins{};          ///< how many
    std::array<double, 2> tension{};       ///< elastic tensions of the inner links of a strand [N]
    std::array<double, 2> links{};         ///< how many
    double touching = 0.0;                 ///< tips that press
    std::array<double, 2> hold{}, drag{};  ///< see Creep (model/observe/chain_forces.hpp) [N·m·s], [N·m]
    double creep_power = 0.0;              ///< [W]
};

/// Each function reads and writes columns of all pins; the caller renews the copies of neighbours in between.
struct RigidKernels {
    /// Pitch lines from coordinates and velocities.
    void (*pitch_lines)(RigidColumns& columns) noexcept;
    /// Directions and offsets of the halves that roll on each other, from the pitch lines.
    void (*rolling_frames)(const RigidCoefficients& c, RigidColumns& columns) noexcept;
    /// Forces of links; adds energies and losses.
    void (*link_forces)(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& columns, Account& account) noexcept;
    /// Bending of the pins, normal force and rolling resistance of their joints, and A g of the links' forces.
    void (*joint_forces)(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& columns, Account& account) noexcept;
    /// Sum of the links' forces on each pin, per coordinate.
    void (*sum_link_forces)(RigidColumns& columns) noexcept;
    /// Rates at which pins lengthen along their axes, of velocities as they are. @param sheaves [4]
    void (*axial_rates)(const RigidCoefficients& c, const SheaveMotion* sheaves, RigidColumns& columns) noexcept;
    /// Friction of plates along the pins, which lengthen meanwhile; in a step behind press_tips().
    void (*plate_friction)(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& columns, Account& account) noexcept;
    /// Normal forces and friction of the tips, of velocities as they are. @param sheaves [4]
    void (*tips)(const RigidCoefficients& c, const SheaveMotion* sheaves, RigidColumns& columns, RigidReaction& reaction,
                 Account& account) noexcept;
    /// In a step: normal forces of the tips, and their forces along the pins with the friction of the last step. @param sheaves [4]
    /// @param kick must live until rub_tips()   @param room [room_bytes()] on a cache line, for rub_tips()
    void (*press_tips)(const RigidCoefficients& c, const SheaveMotion* sheaves, const RigidKick& kick, RigidColumns& columns,
                       std::byte* room, RigidReaction& reaction, Account& account) noexcept;
    std::size_t (*room_bytes)(int pins) noexcept;
    /// Of waves() and accelerate(), of zeros at first.
    std::size_t (*wave_bytes)(int pins) noexcept;
    /// Behind plate_friction(): forces of the tips with the friction of the last step.
    void (*push_tips)(RigidColumns& columns, std::byte* room, Account& account) noexcept;
    /// Then: changes of the velocities in the plane over the step, by all forces so far.
    void (*waves)(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& columns, std::byte* room) noexcept;
    /// Then: friction of the tips that these velocities leave, and forces by it.
    void (*rub_tips)(RigidColumns& columns, std::byte* room, RigidReaction& reaction, Account& account) noexcept;
    /// Friction of the halves of a pin on each other, behind the tips.
    void (*joint_friction)(const RigidKick& kick, RigidColumns& columns, Account& account) noexcept;
    /// Moments of the tips on the pitch lines.
    void (*moments)(RigidColumns& columns) noexcept;
    /// Accelerations by the sum of all forces.
    void (*accelerate)(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& columns, std::byte* room) noexcept;
    /// Coordinates by velocities over a time [s].
    void (*drift)(double step, RigidColumns& columns) noexcept;
    /// Velocities by accelerations over a time [s]. @return ½ v·M v' of the pins' velocities before and after, which a leapfrog conserves
    /// in any linear oscillation; M with the inertia of waves [J]
    double (*kick)(const RigidCoefficients& c, double step, RigidColumns& columns) noexcept;
    /// Depths of the tips of pins 0 … 7 [m]. @param depth [tips][8]
    void (*depths)(const RigidCoefficients& c, const SheaveMotion* sheaves, RigidColumns& columns, double* depth) noexcept;
    /// How many pins' tips number `tip` press that did not, or the other way round; pins that fill the last vector count.
    double (*contact_changes)(RigidColumns& columns, int tip) noexcept;
    /// Sums over pins and tips. @param lead by which velocities are ahead of coordinates [s]
    void (*observe)(const RigidCoefficients& c, double lead, const RigidColumns& columns, RigidSums& sums) noexcept;
};

}  // namespace cvtflow::model
