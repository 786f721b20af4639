#pragma once
/// Numbers of rigid pins, derived once from the parameters, and the columns of a chain of them: one array per quantity, pins side by side.
/// (model/EQUATIONS.md section 11)

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include "model/basis/columns.hpp"
#include "model/machine/coefficients.hpp"

namespace cvtflow::model {

/// Pins that a kernel computes side by side; the same for every instruction set, so that sums have the same order.
inline constexpr int rigid_lanes = 8;
inline constexpr int rigid_coordinates = 8;  ///< of a pin: x, y, z, p, q, ζ and two of bending
inline constexpr int rigid_tips = 4;         ///< of a pin: front half at -z and +z, rear half at -z and +z
inline constexpr double far_depth = -1.0;    ///< of tips that are far from any sheave [m]

/// Columns, in groups whose members follow each other. Pin i lies before link i; pitch line i belongs to link i.
enum class Column {
    // Coordinates of the pins and their velocities: middle (x, y, z), displacement (p, q) of the end at +z against the middle, ζ: z of the
    // front half minus z of the rear half, displacement of both ends by bending [m], [m/s].
    x,
    y,
    z,
    p,
    q,
    slide,
    bend_x,
    bend_y,
    vx,
    vy,
    vz,
    vp,
    vq,
    vslide,
    vbend_x,
    vbend_y,
    // Constants of the links: ℓ_0 and its inverse, spring and damper of yaw, shear and torsion, in end displacements.
    free_length,
    inverse_length,
    yaw,
    yaw_damping,
    shear,
    shear_damping,
    torsion,
    torsion_damping,
    // Pitch lines: direction t, 1/ℓ, turning rate θ'.
    line_x,
    line_y,
    line_inverse,
    line_turn,
    // Rolling of the halves of a pin: bisector b, factors of A, offset u of the halves and its rate u'.
    bisector_x,
    bisector_y,
    along,
    across,
    part_x,
    part_y,
    part_vx,
    part_vy,
    // Forces of link i on its front half; the rear half has the opposite, but for shear. bow_: on the bending of its pins.
    pull_x,
    pull_y,
    pull_z,
    twist_x,
    twist_y,
    shear_x,
    shear_y,
    bow_x,
    bow_y,
    tension,
    // Forces of the links' dampers: of stretch, yaw, torsion, shear and bow.
    stretch_drag,
    yaw_drag,
    torsion_drag,
    shear_drag,
    bow_drag,
    // Forces of the pins' dampers: of bending along the travel and across.
    bend_drag_along,
    bend_drag_across,
    // A g of the links' forces, resistance to rolling, moment of bending on each pitch line, normal force between the halves, generalised
    // forces of the links on the pin (without
    // friction of plates and of halves along the pin).
    lean_x,
    lean_y,
    rolling,
    bend_moment,
    pressing,
    force_x,
    force_y,
    force_z,
    force_p,
    force_q,
    force_slide,
    force_bend_x,
    force_bend_y,
    // Friction between neighbouring links' plates along the pins: of all plates, of those at +z less those at -z, both in the last step;
    // sliding speeds of both behind the step; without friction, sliding speed of the pins and friction; friction per sliding speed, of all
    // and of those at +z.
    rub,
    rub_spread,
    rub_before,
    rub_spread_before,
    rub_speed_low,
    rub_speed_high,
    rub_drive,
    rub_push,
    rub_grip,
    rub_grip_high,
    // Friction between the halves of a pin along it, of this step and of the last one; sliding speed behind the step; without friction of
    // plates, sliding speed and friction per sliding speed; degree to which halves stick together, 0 … 1; velocity of the pin along z
    // without friction of plates; force of the tips on ζ that all of these count with.
    joint,
    joint_before,
    joint_speed,
    joint_drive,
    joint_grip,
    joint_tie,
    axial_drive,
    tip_slide_expected,
    // Equations of the links' friction, shared out over lanes (rigid_plates.hpp).
    ring_push,
    ring_grip,
    ring_tie_behind,
    ring_tie_ahead,
    ring_ahead,
    ring_behind,
    ring_rub,
    // > 0: the pin may touch in this step; whether tips' numbers were written for it in the last step and (+2) in this one
    // (near_pins.hpp).
    near,
    written,
    // Depth of each tip, `far_depth` of pins that certainly do not touch; only of velocities as they are (RigidKick).
    depth,
    // Tips: of their force along z on the front and on the rear half, stiffness and rate of change if that half stood still along z; A g,
    // moments on the pitch lines in front and behind, and moment on pitch line i of this and of the last step.
    tip_stiffness_front = depth + rigid_tips,
    tip_stiffness_rear,
    tip_loading_front,
    tip_loading_rear,
    tip_lean_x,
    tip_lean_y,
    tip_front,
    tip_rear,
    tip_moment,
    tip_moment_before,
    // Generalised forces of the tips on the pin.
    tip_x,
    tip_y,
    tip_z,
    tip_p,
    tip_q,
    tip_slide,
    tip_bend_x,
    tip_bend_y,
    // e': rate at which an end moves outward against the middle as the pin lengthens, mean of both halves and ends [m/s].
    lengthening,
    // Forces of each tip: normal force, its damping part, friction along the circumference and along the flank; force on its sheave, away
    // from the axis and along z, only of velocities as they are.
    normal,
    tip_drag = normal + rigid_tips,
    round = tip_drag + rigid_tips,
    flank = round + rigid_tips,
    outward = flank + rigid_tips,
    axial = outward + rigid_tips,
    // Sliding speed of each tip and its distance from the axis, only of velocities as they are.
    sliding = axial + rigid_tips,
    reach = sliding + rigid_tips,
    // 1 for each tip that pressed at the last evaluation, else 0.
    touching = reach + rigid_tips,
    count = touching + rigid_tips
};

/// Column number `offset` of the group that begins with `first`.
[[nodiscard]] constexpr Column operator+(Column first, int offset) noexcept {
    return static_cast<Column>(static_cast<int>(first) + offset);
}

/// All columns; each has copies of its cyclic neighbours in front (one) and behind (a vector).
class RigidColumns {
public:
    explicit RigidColumns(int pins)
        : pins_(pins),
          padded_((pins + rigid_lanes - 1) / rigid_lanes * rigid_lanes),
          stride_(padded_ + 2 * rigid_lanes),
          memory_(static_cast<std::size_t>(static_cast<int>(Column::count) * stride_), 0.0) {}

    [[nodiscard]] int pins() const noexcept { return pins_; }
    /// Pins including those that fill the last vector, which are copies of the first.
    [[nodiscard]] int padded() const noexcept { return padded_; }
    /// Entry of pin 0; entries -1 … padded() + lanes - 1 exist.
    [[nodiscard]] double* operator[](Column c) noexcept { return memory_.data() + static_cast<int>(c) * stride_ + rigid_lanes; }
    [[nodiscard]] const double* operator[](Column c) const noexcept { return memory_.data() + static_cast<int>(c) * stride_ + rigid_lanes; }

    /// Renews the copies of neighbours of columns first … last.
    void wrap(Column first, Column last) noexcept {
        for (int c = static_cast<int>(first); c <= static_cast<int>(last); ++c) {
            double* values = (*this)[static_cast<Column>(c)];
            values[-1] = values[pins_ - 1];
            if (pins_ >= rigid_lanes) {
                std::array<double, rigid_lanes> first;  // copied at once: source and target do not overlap, which the compiler cannot know
                std::memcpy(first.data(), values, sizeof first);
                std::memcpy(values + pins_, first.data(), sizeof first);
            } else {
                for (int k = pins_; k < pins_ + rigid_lanes; ++k) values[k] = values[k - pins_];
            }
        }
    }

    /// Copies behind the last pin become the numbers of the first pins. @param count [≤ lanes, ≤ pins]
    void unwrap(Column first, Column last, int count) noexcept {
        for (int c = static_cast<int>(first); c <= static_cast<int>(last); ++c) {
            double* values = (*this)[static_cast<Column>(c)];
            for (int k = 0; k < count; ++k) values[k] = values[pins_ + k];
        }
    }

    /// Zeros to entries i … i + count - 1 of columns first … last.
    void clear(Column first, Column last, int i, int count) noexcept {
        double* values = (*this)[first] + i;
        for (int c = static_cast<int>(first); c <= static_cast<int>(last); ++c, values += stride_) {
            for (int k = 0; k < count; ++k) values[k] = 0.0;
        }
    }

    /// All entries of one column to another.
    void copy(Column from, Column to) noexcept { std::copy_n((*this)[from] - rigid_lanes, stride_, (*this)[to] - rigid_lanes); }

    [[nodiscard]] int stride() const noexcept { return stride_; }
    [[nodiscard]] std::size_t bytes() const noexcept { return memory_.size() * sizeof(double); }

private:
    int pins_, padded_, stride_;
    LineVector<double> memory_;
};

/// Where the columns are, to be held by value: behind each write to a column the compiler would read it from RigidColumns again.
class RigidView {
public:
    explicit RigidView(RigidColumns& columns) noexcept
        : first_(columns[Column{}]), stride_(columns.stride()), pins_(columns.pins()), padded_(columns.padded()) {}
    [[nodiscard]] double* operator[](Column c) const noexcept { return first_ + static_cast<int>(c) * stride_; }
    [[nodiscard]] int pins() const noexcept { return pins_; }
    [[nodiscard]] int padded() const noexcept { return padded_; }

private:
    double* first_;
    std::ptrdiff_t stride_;
    int pins_, padded_;
};

/// b √δ_0 up to which the start of Newton's method for tips is within 1e-4 (rigid_tip.hpp).
inline constexpr double well_started_softness = 2.0;

struct RigidCoefficients {
    explicit RigidCoefficients(const Parameters& parameters);

    int pins;
    double mass;         ///< of a pin with its share of plates [kg]
    double tilt_mass;    ///< inertia of the end displacements p and q [kg]
    double slide_mass;   ///< inertia of ζ: a quarter of the mass [kg]
    double bend_mass;    ///< inertia of bending [kg]
    double half_length;  ///< ℓ_p/2 [m]

    // Bending of both halves.
    double bend_share;      ///< displacement of the ends against the mean of the plates, per x_2
    Spring travel, height;  ///< along the direction of travel and across, of displacements of the ends
    Spring bow;             ///< of a link between pins that bend differently along the travel: plates and joint in series
    double bend_slope;      ///< of the ends: slope by bending, as a displacement by tilting
    double bend_lever;      ///< displacement of a sphere's centre per displacement of the ends by bending

    // Links.
    Spring pull;           ///< plates and joint in series
    double plate_square;   ///< mean ξ² of the plates
    double plate_reach;    ///< ξ̂: its root
    double arm, diameter;  ///< c_a = ρ - w/2, 2ρ [m]
    double rolling_arm;    ///< a_r over sqrt(N) [m/√N]
    FrictionCurve plate_friction, joint_friction;

    // Tips.
    double sine, cosine;     ///< of β
    double radius;           ///< R_p [m]
    double outward;          ///< R_p sin β [m]
    double inverse_reach;    ///< 1/(R_c + R_p) [1/m]
    double touching_radius;  ///< r_m + R_p sin β [m]
    double lever;            ///< 1 - (2/ℓ_p) R_p cos β: displacement of a sphere's centre per end displacement
    double hertz, damping;   ///< K of one tip [N/m^1.5], χ_T [s/m]
    double softness;         ///< b = K cos²β/k_e: axial compliance of half a pin beside Hertz's [1/√m]
    int further_steps;       ///< of Newton's method, for tips that yield more than its start is made for
    FrictionCurve tip_friction;
    std::shared_ptr<TipLaw> tip_law;  ///< nullptr: none
    double middle;                    ///< a/2 [m]

    /// Inertia of coordinate number k [kg].
    [[nodiscard]] constexpr double inertia(int k) const noexcept {
        return k < 3 ? mass : k < 5 ? tilt_mass : k < 6 ? slide_mass : bend_mass;
    }
    /// Writes the constants of the links into their columns.
    void fill(const Parameters& parameters, RigidColumns& columns) const;

private:
    /// Numbers of bending, behind those of the links. @param plate_bow as of Coefficients
    void bend(const Parameters& parameters, double plate_bow);
};

}  // namespace cvtflow::model
