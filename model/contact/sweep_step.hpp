#pragma once
/// Friction solved for by implicit sweeps over its contacts. Friction of a step is that of the velocities at ϑ of it,
///
///     v = v_0 + ϑ h (G + A⁻¹ Σ Jᵀ P),   P = -c s(|u|) u/|u|,   u = J v,   c = μN,   at the end v_0 + (v - v_0)/ϑ,
///
/// with each contact's force P found from the velocities that all others leave it: u = u* + r (P - P before), r its response. Joint points
/// are solved one after the other, joints of different pins at once, and so are links with their plates and tips. Forces are kept from step
/// to step as shares of c, and the next step begins with them and half of their last change.

#include <array>

#include "model/contact/friction_operator.hpp"

namespace cvtflow::model {

/// Rows of what sweeps keep of a link from step to step; its joint is that of its rear pin.
struct SweepRows {
    /// Rows of a link that its waves move: x and y of both halves.
    static constexpr int wave_rows = 4 * axis_terms;
    int joint_points;  ///< integration points of a joint

    /// Share of a point's force across the axis, and along it in the next row [1].
    [[nodiscard]] static constexpr int joint(int point) noexcept { return 2 * point; }
    /// Friction of all plates: along z, and its moment in the next row [N].
    [[nodiscard]] constexpr int plates() const noexcept { return joint(joint_points); }
    /// Share of a tip's force: along the link, across it, along z [1].
    [[nodiscard]] constexpr int tip(int corner) const noexcept { return plates() + 2 + 3 * corner; }
    /// Rows so far.
    [[nodiscard]] constexpr int forces() const noexcept { return tip(tips_per_link); }
    /// Row with which the next step begins instead of a row of the forces.
    [[nodiscard]] constexpr int opening(int row) const noexcept { return forces() + row; }
    /// Speed at which the tangent of a joint point's equation was taken last [m/s].
    [[nodiscard]] constexpr int joint_speed(int point) const noexcept { return 2 * forces() + point; }
    /// Sliding of the plates by which their secants were taken last: z, and e in the next row [m/s].
    [[nodiscard]] constexpr int plate_rate() const noexcept { return joint_speed(joint_points); }
    /// Low pass of the accelerations by friction, of row x or y of the link [m/s²].
    [[nodiscard]] constexpr int lasting(int row) const noexcept { return plate_rate() + 2 + row; }
    [[nodiscard]] constexpr int count() const noexcept { return lasting(wave_rows); }
};

/// Share of the new value in the low pass: with three sweeps 0.1 feeds waves of one of twelve machines, 0.3 of three [1].
inline constexpr double lasting_share = 0.03;

/// ϑ: instant at which friction is solved, in steps from the step's beginning; 1 is backward Euler, 1/2 damps no error of a sweep [1].
inline constexpr double sweep_time = 0.75;

/// Responses of a contact's sliding to forces over ϑ h.
struct SweepResponses {
    /// @param step h [s]   @param nominal what a step takes that nothing cuts short: contacts respond as if this were its length [s]
    SweepResponses(const FrictionOperator& friction, double step, double nominal) noexcept;

    float step;                                                                  ///< ϑ h [s]
    std::array<float, max_joint_lanes> joint_across{}, joint_along{};            ///< response of a point to its force [m/s per N]
    std::array<std::array<float, axis_terms>, max_joint_lanes> joint_lateral{};  ///< response of a joint's modes to the force at a point
    float joint_shift;                                                           ///< response of its z to an axial force
    std::array<float, max_joint_lanes> joint_tilt{};                             ///< response of its e to the axial force at a point
    float tip;                      ///< response of a tip to equal forces at all tips of its link
    float plate_shift, plate_tilt;  ///< responses of the plates' z and e to their force and moment
    float link_shift, link_tilt;    ///< responses of either end's z and e to the plates' force and moment, over ϑ of the present step
    double of_step, of_nominal;     ///< arguments that they were made from [s]
};

/// Part of a step.
enum class SweepPart {
    opening,  ///< velocities with the forces of the step before, half their last change added; then plates and tips of the links
    middle,   ///< joints, then links
    closing,  ///< joints; then the velocities
};

/// One pass over joints and links. Columns over links (column = link + range.shift), all of the same shape.
struct FrictionSweep {
    SweepPart part;
    float ahead;  ///< share of the forces' last change with which the next step begins [1]
    const SweepResponses* responses;
    FloatColumns* base;             ///< accelerations by everything but friction; in: with those that last, unfiltered
    const FloatColumns* start;      ///< velocities at the step's start
    const FloatColumns* before;     ///< [SweepRows::count()] rows, as the step before has left them
    FloatColumns* kept;             ///< the same of this step
    FloatColumns* velocity;         ///< velocities at ϑ so far, those of the range
    FloatColumns* result;           ///< velocities at the end
    FloatColumns* mean_tip_forces;  ///< [3 tips_per_link] rows: mean force on each tip, x, y, z [N]
};

/// Power that friction takes from a link, with the joint of its rear pin, by kind [W].
struct FrictionPowers {
    double joint, plates, tips;
};

}  // namespace cvtflow::model
