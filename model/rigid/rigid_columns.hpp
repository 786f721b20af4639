#pragma once
/// Columns of a chain of rigid pins: one array per quantity, pins side by side. One block of memory with a stride, and not a structure of
/// pointers: the kernels find an array by base and number, where a pointer would be a load for each access.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include "model/basis/columns.hpp"

namespace cvtflow::model {

/// Pins that a kernel computes side by side; the same for every instruction set, so that sums have the same order.
inline constexpr int rigid_lanes = 8;
inline constexpr int rigid_coordinates = 8;  ///< coordinates per pin: x, y, z, p, q, ζ and two of bending
inline constexpr int rigid_tips = 4;         ///< tips per pin: front half at -z and +z, rear half at -z and +z
inline constexpr double far_depth = -1.0;    ///< depth of tips that are far from any sheave [m]

/// Quantities of a chain of rigid pins, one array each. Entry i belongs to pin i, or where so said to link i between the pins i and i+1.
/// Columns of one heading follow each other. (model/EQUATIONS.md section 11; symbols as there)
enum class Column {
    // Coordinates of a pin.
    x,       ///< x of the middle Q [m]
    y,       ///< y of the middle Q [m]
    z,       ///< z of the middle Q [m]
    p,       ///< p = D_x: x of the end at +z against the middle [m]
    q,       ///< q = D_y: y of the end at +z against the middle [m]
    slide,   ///< ζ: z of the front half less z of the rear half [m]
    bend_x,  ///< x of both ends by bending [m]
    bend_y,  ///< y of both ends by bending [m]
    // Velocities of a pin, in the order of the coordinates.
    vx,       ///< x' [m/s]
    vy,       ///< y' [m/s]
    vz,       ///< z' [m/s]
    vp,       ///< p' [m/s]
    vq,       ///< q' [m/s]
    vslide,   ///< ζ' [m/s]
    vbend_x,  ///< bend_x' [m/s]
    vbend_y,  ///< bend_y' [m/s]
    // Accelerations of a pin, in the order of the coordinates.
    acceleration_x,       ///< x'' [m/s²]
    acceleration_y,       ///< y'' [m/s²]
    acceleration_z,       ///< z'' [m/s²]
    acceleration_p,       ///< p'' [m/s²]
    acceleration_q,       ///< q'' [m/s²]
    acceleration_slide,   ///< ζ'' [m/s²]
    acceleration_bend_x,  ///< bend_x'' [m/s²]
    acceleration_bend_y,  ///< bend_y'' [m/s²]
    // Constants of a link; yaw and torsion against displacements of the ends, shear against an angle.
    free_length,        ///< ℓ_0 [m]
    inverse_length,     ///< 1/ℓ_0 [1/m]
    yaw_stiffness,      ///< k_ψ [N/m]
    yaw_damping,        ///< d_ψ [N·s/m]
    shear_stiffness,    ///< k_γ [N·m]
    shear_damping,      ///< d_γ [N·m·s]
    torsion_stiffness,  ///< k_χ [N/m]
    torsion_damping,    ///< d_χ [N·s/m]
    longer,             ///< λ: excess of half the pin's length over ℓ_p/2 [m]
    // Pitch line of a link.
    line_x,           ///< t_x: direction
    line_y,           ///< t_y: direction
    line_inverse,     ///< 1/ℓ [1/m]
    line_turn,        ///< θ': turning rate [rad/s]
    line_turn_ahead,  ///< θ' at the end of the step, extrapolated from this step and the last one [rad/s]
    // Rolling of the halves of a pin on each other.
    bisector_x,      ///< b_x: direction of the bisector of both pitch lines
    bisector_y,      ///< b_y: direction of the bisector of both pitch lines
    rolling_along,   ///< factor of f in A f [m]
    rolling_across,  ///< factor of b (b·f) in A f [m]
    offset_x,        ///< u_x: front half against rear half [m]
    offset_y,        ///< u_y: front half against rear half [m]
    offset_vx,       ///< u_x' [m/s]
    offset_vy,       ///< u_y' [m/s]
    offset_ahead_x,  ///< u_x' at the end of the step, by line_turn_ahead [m/s]
    offset_ahead_y,  ///< u_y' at the end of the step, by line_turn_ahead [m/s]
    // Forces of a link on its front half. The rear half has the opposite; of shear_x and shear_y the same.
    pull_x,   ///< force on the middle, x [N]
    pull_y,   ///< force on the middle, y [N]
    pull_z,   ///< force on the middle, z [N]
    twist_x,  ///< yaw and torsion, generalised force on p [N]
    twist_y,  ///< yaw and torsion, generalised force on q [N]
    shear_x,  ///< shear, generalised force on p [N]
    shear_y,  ///< shear, generalised force on q [N]
    bow_x,    ///< opposite of the generalised force on bend_x [N]
    bow_y,    ///< opposite of the generalised force on bend_y [N]
    tension,  ///< T: tension of all plates, with damping [N]
    // Damping forces, kept for the loss of the next step.
    stretch_damping_force,      ///< force against the rate ε' of a link's plates [N]
    yaw_damping_force,          ///< force against the rate ψ' of a link [N]
    torsion_damping_force,      ///< force against the rate χ' of a link [N]
    shear_damping_force,        ///< moment against the rate γ' of a link [N·m]
    bow_damping_force,          ///< force against the bow rate of a link [N]
    bend_damping_force_along,   ///< force against the rate of a pin's bending along the travel [N]
    bend_damping_force_across,  ///< force against the rate of a pin's bending across the travel [N]
    guide_damping_force,        ///< force of a guide against a pin's approach [N]
    guide_friction,             ///< force of a guide against a pin's speed along the strand [N]
    // Joint between the halves of a pin.
    offset_moment_x,  ///< A g of the links' forces, x [N·m]
    offset_moment_y,  ///< A g of the links' forces, y [N·m]
    rolling_moment,   ///< resistance to rolling [N·m]
    bend_moment,      ///< moment of a pin's bending on each of its two pitch lines [N·m]
    joint_normal,     ///< N_j: normal force between the halves [N]
    // Forces on a pin by links and its bending, without friction along it, in the order of the coordinates [N].
    force_x,
    force_y,
    force_z,
    force_p,
    force_q,
    force_slide,
    force_bend_x,
    force_bend_y,
    // Friction between the plates of link i and its pins along z. Low and high: half of the plates each, at -z and at +z.
    plate_friction,                ///< P: friction of all plates [N]
    plate_friction_moment,         ///< Π: friction of the plates at +z less that of those at -z [N]
    plate_friction_before,         ///< P of the last step [N]
    plate_friction_moment_before,  ///< Π of the last step [N]
    plate_slip_low,                ///< sliding speed at the end of the step [m/s]
    plate_slip_high,               ///< sliding speed at the end of the step [m/s]
    plate_slip_low_before,         ///< plate_slip_low of the last step [m/s]
    plate_slip_high_before,        ///< plate_slip_high of the last step [m/s]
    plate_free_slip,               ///< sliding speed without plate friction [m/s]
    plate_rhs,                     ///< B: friction of the free sliding speeds [N]
    plate_secant,                  ///< F: friction per sliding speed, of all plates [N·s/m]
    plate_secant_high,             ///< friction per sliding speed of the plates at +z [N·s/m]
    // Friction between the halves of a pin along z.
    joint_friction,            ///< J: friction against ζ' [N]
    joint_friction_before,     ///< J of the last step [N]
    joint_slip,                ///< ζ' at the end of the step [m/s]
    joint_slip_before,         ///< joint_slip of the last step [m/s]
    joint_free_slip,           ///< ζ' without this friction [m/s]
    joint_secant,              ///< friction per free sliding speed [N·s/m]
    joint_coupling,            ///< β: share of a force parting the halves that friction between them takes, 0 … 1
    axial_free_speed,          ///< z' without friction of plates [m/s]
    tip_force_slide_expected,  ///< force of the tips on ζ that the frictions along the pin count with [N]
    // Equations of the plates' friction, in the order of RingShares: entry row · lanes + lane.
    ring_rhs,             ///< plate_rhs [N]
    ring_secant,          ///< plate_secant [N·s/m]
    ring_coupling_rear,   ///< joint_coupling of the pin at the rear of the link
    ring_coupling_front,  ///< joint_coupling of the pin at its front
    ring_upper,           ///< factor of the next row
    ring_lower,           ///< factor of the last row of the lane before
    ring_solution,        ///< plate_friction [N]
    // Which tips are computed.
    near,     ///< > 0: the pin may touch in this step
    written,  ///< tips' columns were written: 1 in the last step, 2 in this one, 0 not
    // Contact of a pin's tips as a whole. Depth holds for velocities as they are (RigidKick), too.
    tip_depth,                                     ///< [4] δ_0: depth of each tip, `far_depth` of pins that certainly do not touch [m]
    tip_stiffness_front = tip_depth + rigid_tips,  ///< stiffness of the front half's tips against its motion along z [N/m]
    tip_stiffness_rear,                            ///< stiffness of the rear half's tips [N/m]
    tip_loading_front,                             ///< rate of the force on the front half if it stood still along z [N/s]
    tip_loading_rear,                              ///< rate of the force on the rear half [N/s]
    tip_damping_front,                             ///< damping of the front half's tips against its motion along z [N·s/m]
    tip_damping_rear,                              ///< damping of the rear half's tips [N·s/m]
    tip_offset_moment_x,                           ///< A g of the tips' forces, x [N·m]
    tip_offset_moment_y,                           ///< A g of the tips' forces, y [N·m]
    tip_moment_front,                              ///< moment of the front half's tips on the pitch line behind the pin [N·m]
    tip_moment_rear,                               ///< moment of the rear half's tips on the pitch line ahead of the pin [N·m]
    tip_moment,                                    ///< moment of all tips on pitch line i [N·m]
    tip_moment_before,                             ///< tip_moment of the last step [N·m]
    // Forces of a pin's tips on it, in the order of the coordinates [N].
    tip_force_x,
    tip_force_y,
    tip_force_z,
    tip_force_p,
    tip_force_q,
    tip_force_slide,
    tip_force_bend_x,
    tip_force_bend_y,
    lengthening,  ///< e': outward velocity of an end against the middle as the pin lengthens, mean of halves and ends [m/s]
    // Force of each tip, [4]: front half at -z and +z, rear half at -z and +z.
    tip_normal,                                       ///< [4] N: normal force [N]
    tip_damping_force = tip_normal + rigid_tips,      ///< [4] damping part of the normal force [N]
    tip_tangential = tip_damping_force + rigid_tips,  ///< [4] friction on the pin along the circumference [N]
    tip_radial = tip_tangential + rigid_tips,         ///< [4] friction on the pin along the flank [N]
    // Each tip, for observation.
    sheave_outward = tip_radial + rigid_tips,    ///< [4] force on the sheave, away from its axis [N]
    sheave_axial = sheave_outward + rigid_tips,  ///< [4] force on the sheave along z [N]
    tip_grip = sheave_axial + rigid_tips,        ///< [4] friction per sliding speed, behind the friction of the step [N·s/m]
    tip_radius = tip_grip + rigid_tips,          ///< [4] distance from the axis [m]
    touching = tip_radius + rigid_tips,          ///< [4] 1 where the tip was last found to press, else 0
    // Memory of friction laws.
    remembered_speed = touching + rigid_tips,  ///< [4] w: sliding speed that the friction of a tip follows [m/s]
    count = remembered_speed + rigid_tips
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
    [[gnu::always_inline]] void wrap(Column first, Column last) noexcept {
        for (int c = static_cast<int>(first); c <= static_cast<int>(last); ++c) {
            double* values = (*this)[static_cast<Column>(c)];
            values[-1] = values[pins_ - 1];
            if (pins_ >= rigid_lanes) {
                std::array<double, rigid_lanes> copy;  // at once: source and target do not overlap, which the compiler cannot know
                std::memcpy(copy.data(), values, sizeof copy);
                std::memcpy(values + pins_, copy.data(), sizeof copy);
            } else {
                for (int k = pins_; k < pins_ + rigid_lanes; ++k) values[k] = values[k - pins_];
            }
        }
    }

    /// Copies behind the last pin become the numbers of the first pins. @param count [≤ lanes, ≤ pins]
    [[gnu::always_inline]] void unwrap(Column first, Column last, int count) noexcept {
        for (int c = static_cast<int>(first); c <= static_cast<int>(last); ++c) {
            double* values = (*this)[static_cast<Column>(c)];
            for (int k = 0; k < count; ++k) values[k] = values[pins_ + k];
        }
    }

    /// Zeros to entries i … i + count - 1 of columns first … last.
    [[gnu::always_inline]] void clear(Column first, Column last, int i, int count) noexcept {
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

}  // namespace cvtflow::model
