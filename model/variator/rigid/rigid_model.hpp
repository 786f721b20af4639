#pragma once
/// A chain of rigid pins: the forces on its pins and sheaves. (model/EQUATIONS.md section 11)

#include "model/variator/rigid/rigid_kernels.hpp"

namespace cvtflow::model {

/// Forces of an instant beside those in the columns.
struct RigidForces {
    RigidReaction reaction;
    Account account;  ///< potential energies and losses of the chain
};

class RigidModel {
public:
    /// @param parameters with detail.pins = rigid
    /// @throws std::invalid_argument if the instruction set is not compiled in
    explicit RigidModel(const Parameters& parameters, Isa isa = chosen_isa());

    [[nodiscard]] const ChainLayout& layout() const noexcept { return layout_; }
    [[nodiscard]] const RigidCoefficients& coefficients() const noexcept { return coefficients_; }
    [[nodiscard]] const RigidKernels& kernels() const noexcept { return kernels_; }
    /// Columns with the constants of the links; everything else is zero.
    [[nodiscard]] RigidColumns columns() const;

    /// Accelerations of the pins into the columns force_x … force_bend_y, at coordinates and velocities of the columns.
    /// @param sheaves [4], nullptr: there are no pulleys
    void accelerate(const SheaveMotion* sheaves, const RigidKick& kick, RigidColumns& columns, RigidForces& forces) const noexcept;
    /// The same with friction of the velocities as they are, which no step before has left anything of.
    void accelerate(const SheaveMotion* sheaves, RigidColumns& columns, RigidForces& forces) const noexcept;

    /// Of a coordinate or velocity in the columns, per one of a state.
    [[nodiscard]] double scale(int k) const noexcept { return k < 6 ? 1.0 : coefficients_.bend_share; }
    /// Columns of coordinates and velocities from and to blocks of a state. @param blocks [pins * layout().link_block()]
    void read(const double* blocks, RigidColumns& columns) const noexcept;
    void write(const RigidColumns& columns, double* blocks) const noexcept;
    /// Accelerations in the columns, in the order of a block's velocities. @param of_pin [layout().link_size()]
    void acceleration(const RigidColumns& columns, int pin, double* of_pin) const noexcept;

private:
    Parameters parameters_;
    ChainLayout layout_;
    RigidCoefficients coefficients_;
    RigidKernels kernels_;
};

/// Coordinate number k of the columns (x, y, z, p, q, ζ, bending) inside the block of a pin.
[[nodiscard]] constexpr int rigid_place(const ChainLayout& at, int k) noexcept {
    const int places[rigid_coordinates] = {at.x(End::rear, 0), at.y(End::rear, 0), at.z(End::rear),    at.x(End::rear, 1),
                                           at.y(End::rear, 1), at.slide(),         at.x(End::rear, 2), at.y(End::rear, 2)};
    return places[k];
}

}  // namespace cvtflow::model
