#pragma once
/// State of a chain of rigid pins between two steps of a leapfrog, in columns: coordinates and forces at one time, velocities ahead of
/// them; and the unknowns behind the pins likewise. (model/EQUATIONS.md section 11)

#include <vector>

#include "model/rigid/rigid_chain.hpp"

namespace cvtflow::model {

struct RigidState {
    explicit RigidState(const RigidModel& model);

    /// Takes a state over; velocities are not ahead. @param y [unknowns]
    void read(const double* y);
    /// The state at the time of the coordinates. @param y [unknowns]
    void write(double* y) const noexcept;
    /// The unknowns that a kick changes behind the pulleys' coordinates end here: velocities and integrals. Unknowns of the hydraulics
    /// drift.
    [[nodiscard]] std::size_t kicked_end() const noexcept;
    /// Kinetic energy that the accelerations of the pins would have as velocities, ½ a·M a [J/s²].
    [[nodiscard]] double acceleration_energy() const noexcept;
    [[nodiscard]] std::size_t bytes() const noexcept;

    const RigidModel& model;
    RigidColumns columns;
    RigidForces forces;
    std::vector<double> tail, tail_slope;  ///< pulleys, controls, hydraulics, and their rates [unknowns behind the pins but the ledger]
    std::vector<double> ledger;            ///< losses and works so far, where the state has them [J]
    double lead = 0.0;                     ///< by which velocities are ahead [s]
};

/// Columns that the pins keep from step to step: first and last of those that follow each other.
inline constexpr Column kept_columns[][2] = {{Column::x, Column::vbend_y},
                                             {Column::stretch_damping_force, Column::bend_damping_force_across},
                                             {Column::rolling_moment, Column::rolling_moment},
                                             {Column::acceleration_x, Column::acceleration_bend_y},
                                             {Column::plate_friction, Column::plate_slip_high},
                                             {Column::joint_friction, Column::joint_slip},
                                             {Column::tip_stiffness_front, Column::tip_loading_rear},
                                             {Column::tip_moment, Column::tip_moment},
                                             {Column::tip_force_z, Column::tip_force_z},
                                             {Column::tip_force_slide, Column::tip_force_slide},
                                             {Column::lengthening, Column::lengthening},
                                             {Column::tip_normal, Column::tip_radial + (rigid_tips - 1)}};

}  // namespace cvtflow::model
