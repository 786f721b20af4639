#pragma once
/// A chain of rigid pins: the forces on its pins and sheaves, by kernels over all pins (RigidModel); the same chain as a ChainModel
/// evaluates it (RigidChain); its state between two steps of a leapfrog, in columns (RigidState). (model/EQUATIONS.md section 11)

#include <tuple>
#include <vector>

#include "model/kernels/available_isas.hpp"
#include "model/rigid/rigid_kernels.hpp"

namespace cvtflow::model {

/// Forces of an instant beside those in the columns.
struct RigidForces {
    RigidReaction reaction;
    Account account;       ///< potential energies and losses of the chain
    double kinetic = 0.0;  ///< ½ v·M v' of the pins' velocities before and after the kick [J]
};

class RigidModel {
public:
    /// @param parameters with detail.pins = rigid
    /// @throws std::invalid_argument if the instruction set is not compiled in
    explicit RigidModel(const Parameters& parameters, Isa isa = chosen_isa());

    [[nodiscard]] const ChainLayout& layout() const noexcept { return layout_; }
    [[nodiscard]] const RigidCoefficients& coefficients() const noexcept { return coefficients_; }
    /// Kernels over columns of numbers of a type.
    template <class Real = double>
    [[nodiscard]] const RigidKernels<Real>& kernels() const noexcept {
        return std::get<RigidKernels<Real>>(kernels_);
    }
    /// Columns with the constants of the links; everything else is zero.
    [[nodiscard]] RigidColumns columns() const;

    /// Writes accelerations of the pins, at the columns' coordinates and velocities, into the rows of accelerations; friction is that of
    /// the present velocities, without memory of a step before.
    /// @param sheaves [4], nullptr: there are no pulleys
    void accelerate(const SheaveMotion* sheaves, RigidColumns& columns, RigidForces& forces) const noexcept;

    /// Scale of a coordinate or velocity of the columns over that of a state.
    [[nodiscard]] double scale(int k) const noexcept { return k < 6 ? 1.0 : coefficients_.bend_share; }
    /// Copies coordinates and velocities from blocks of a state into columns. @param blocks [pins * layout().link_block()]
    void read(const double* blocks, RigidColumns& columns) const noexcept;
    /// Copies accelerations from the columns, in the order of a block's velocities. @param of_pin [layout().link_size()]
    void acceleration(const RigidColumns& columns, int pin, double* of_pin) const noexcept;

private:
    Parameters parameters_;
    ChainLayout layout_;
    RigidCoefficients coefficients_;
    std::tuple<RigidKernels<double>, RigidKernels<float>> kernels_;
};

/// Coordinate number k of the columns (x, y, z, p, q, ζ, bending) inside the block of a pin.
[[nodiscard]] constexpr int rigid_place(const ChainLayout& at, int k) noexcept {
    const int places[rigid_coordinates] = {at.x(End::rear, 0), at.y(End::rear, 0), at.z(End::rear),    at.x(End::rear, 1),
                                           at.y(End::rear, 1), at.e(End::rear),    at.x(End::rear, 2), at.y(End::rear, 2)};
    return places[k];
}

/// Rigid pins at an instant whose forces are known.
template <class Real>
struct RigidInstantOf {
    const RigidModel& model;
    const RigidColumnsOf<Real>& columns;
    const RigidForces& forces;
    double lead;  ///< time by which the columns' velocities are ahead of their coordinates [s]

    [[nodiscard]] RigidSums sums() const noexcept {
        RigidSums sums;
        model.kernels<Real>().observe(model.coefficients(), lead, columns, sums);
        return sums;
    }
    /// Entry of rows for tip number 2 end + side of a link: that of the pin whose half is at this end.
    [[nodiscard]] double of_tip(const std::array<Real*, rigid_tips>& rows, int link, int tip) const noexcept {
        const int pin = tip < rigid_tips / 2 ? link : model.layout().next(link);
        return rows[static_cast<std::size_t>((tip + rigid_tips / 2) % rigid_tips)][pin];
    }
};

using RigidInstant = RigidInstantOf<double>;

struct ChainKernels;
struct LinkContact;
struct TipProbe;

class RigidChain {
public:
    RigidChain(const Parameters& parameters, Isa isa);

    [[nodiscard]] const RigidModel& model() const noexcept { return model_; }
    /// The functions of a ChainModel that has a RigidChain.
    [[nodiscard]] static ChainKernels kernels() noexcept;

    /// Evaluates all pins.
    /// @param blocks [pins * link_block]   @param sheaves [4], unused without pulleys
    /// @return valid until the next evaluation
    RigidInstant evaluate(const double* blocks, const SheaveMotion* sheaves) const noexcept;
    [[nodiscard]] RigidInstant last() const noexcept { return {model_, columns_, forces_, 0.0}; }  ///< evaluated

    /// Depths of tips of neighbouring links. @param states their blocks, with one more in front and two behind   @param probes [links]
    void probe(const double* states, int links, const SheaveMotion* sheaves, TipProbe* probes) const noexcept;

private:
    RigidModel model_;
    mutable RigidColumns columns_, strip_;
    mutable RigidForces forces_;
};

struct RigidState {
    explicit RigidState(const RigidModel& model);

    /// Reads a state, whose velocities are not ahead, with its forces. @param y [unknowns]   @param now the chain, evaluated there
    void read(const double* y, const RigidInstant& now);
    /// Writes the state at the time of the coordinates. @param y [unknowns]
    void write(double* y) const noexcept;
    /// Writes the part of the state that follows the pins. @param behind [unknowns behind the pins]
    void write_tail(double* behind) const noexcept;
    [[nodiscard]] RigidInstantOf<float> instant() const noexcept { return {model, columns, forces, lead}; }
    /// End of the unknowns behind the pulleys' coordinates that a kick changes: velocities and integrals. The hydraulics' unknowns drift.
    [[nodiscard]] std::size_t kicked_end() const noexcept;
    /// Kinetic energy that the accelerations of the pins would have as velocities, ½ a·M a [J/s²].
    [[nodiscard]] double acceleration_energy() const noexcept;
    [[nodiscard]] std::size_t bytes() const noexcept;

    const RigidModel& model;
    StepColumns columns;
    RigidForces forces;
    std::vector<double> tail, tail_slope;  ///< pulleys, controls, hydraulics, and their rates [unknowns behind the pins but the ledger]
    std::vector<double> ledger;            ///< losses and works so far, where the state has them [J]
    double lead = 0.0;                     ///< time by which velocities are ahead of coordinates [s]
};

}  // namespace cvtflow::model
