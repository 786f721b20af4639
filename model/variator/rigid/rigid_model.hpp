#pragma once
/// A variator of rigid whole pins: its forces, and its slope f(t, y) for any method. (model/EQUATIONS.md section 11)

#include <vector>

#include "model/variator/rigid/rigid_kernels.hpp"

namespace cvtflow::model {

/// Order of the unknowns: coordinates of the pins column by column [x… y… z… p… q…], their velocities, pulleys [q | v], control [I, …].
struct RigidLayout {
    int pins = 84;
    int pulley_size = 36;  ///< 36, 4 or 0
    int controls = 0;

    /// Of coordinate k (0…4: x, y, z, p, q) of pin 0; those of the other pins follow.
    [[nodiscard]] constexpr int coordinate(int k) const noexcept { return k * pins; }
    [[nodiscard]] constexpr int velocity(int k) const noexcept { return (rigid_coordinates + k) * pins; }
    [[nodiscard]] constexpr int pulley_begin() const noexcept { return 2 * rigid_coordinates * pins; }
    [[nodiscard]] constexpr int control_begin() const noexcept { return pulley_begin() + 2 * pulley_size; }
    [[nodiscard]] constexpr int size() const noexcept { return control_begin() + controls; }
    /// Pulleys and controls: what follows the pins.
    [[nodiscard]] constexpr int tail() const noexcept { return size() - pulley_begin(); }
};

/// Forces of an instant beside those in the columns.
struct RigidForces {
    RigidReaction reaction;
    Inputs inputs;
    Account account;  ///< potential energies and losses of the chain
};

class RigidModel {
public:
    /// @throws std::invalid_argument if the instruction set is not compiled in
    explicit RigidModel(const Parameters& parameters, Isa isa = chosen_isa());

    [[nodiscard]] const RigidLayout& layout() const noexcept { return layout_; }
    [[nodiscard]] const RigidCoefficients& coefficients() const noexcept { return coefficients_; }
    [[nodiscard]] const PulleyModel& pulleys() const noexcept { return pulleys_; }
    [[nodiscard]] PulleyModel& pulleys() noexcept { return pulleys_; }
    [[nodiscard]] const RigidKernels& kernels() const noexcept { return kernels_; }
    /// Columns with the constants of the links; everything else is zero.
    [[nodiscard]] RigidColumns columns() const;

    /// Accelerations of the pins into the columns force_x … force_q, at coordinates and velocities of the columns.
    /// @param t [s]   @param tail pulleys and controls
    void accelerate(double t, const double* tail, const RigidKick& kick, RigidColumns& columns, RigidForces& forces) const noexcept;
    /// Slope of pulleys and controls; adds energies and losses of the pulleys to the account. @param tail, slope [layout().tail()]
    void tail_slope(const double* tail, RigidForces& forces, double* slope) const noexcept;

    /// f(t, y). @param y, slope [layout().size()]   @param columns, forces workspace; what they hold of the instant may be read
    void slope(double t, const double* y, double* slope, RigidColumns& columns, RigidForces& forces) const noexcept;
    /// Kinetic energy of a state [J].
    [[nodiscard]] double kinetic(const double* y) const noexcept;

    /// Columns of coordinates and velocities from and to a state. @param y [layout().size()]
    void read(const double* y, RigidColumns& columns) const noexcept;
    void write(const RigidColumns& columns, double* y) const noexcept;

private:
    Parameters parameters_;
    RigidCoefficients coefficients_;
    PulleyModel pulleys_;
    RigidKernels kernels_;
    RigidLayout layout_;
};

/// Geometric start of a scene's machine, as that of all levels of detail. Throws std::invalid_argument if the chain does not close.
[[nodiscard]] std::vector<double> rigid_start(const Parameters& parameters);

}  // namespace cvtflow::model
