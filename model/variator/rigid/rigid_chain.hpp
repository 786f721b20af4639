#pragma once
/// Rigid pins as a ChainModel evaluates them: friction of the velocities as they are, phases of tips unused, as contact begins and
/// ends by itself. One range of all pins at a time, one evaluation at a time. (model/EQUATIONS.md section 11)

#include "model/variator/rigid/rigid_model.hpp"

namespace cvtflow::model {

struct ChainKernels;
struct LinkContact;
struct TipProbe;

class RigidChain {
public:
    RigidChain(const Parameters& parameters, Isa isa);

    [[nodiscard]] const RigidModel& model() const noexcept { return model_; }
    /// The functions of a ChainModel that has a RigidChain.
    [[nodiscard]] static ChainKernels kernels() noexcept;

    /// Evaluates all pins. What is found is valid until the next evaluation.
    /// @param blocks of all pins [pins * link_block]   @param sheaves [4], unused without pulleys
    void evaluate(const double* blocks, const SheaveMotion* sheaves) const noexcept;
    [[nodiscard]] const RigidColumns& columns() const noexcept { return columns_; }
    [[nodiscard]] const RigidForces& forces() const noexcept { return forces_; }
    [[nodiscard]] double kinetic() const noexcept;             ///< energy of the pins evaluated last [J]
    void show_contacts(LinkContact* contacts) const noexcept;  ///< of the links evaluated last [pins]
    /// Entry of the pin whose half is the one at `end` of a link, and of a tip number 2 end + side of a link the column's number.
    [[nodiscard]] int pin_of(int link, int end) const noexcept { return end == 0 ? link : model_.layout().next(link); }
    [[nodiscard]] double of_tip(Column first, int link, int tip) const noexcept {
        return columns_[first + (tip + rigid_tips / 2) % rigid_tips][pin_of(link, tip / 2)];
    }

    /// Depths of tips of neighbouring links. @param states their blocks, with one more in front and two behind   @param probes [links]
    void probe(const double* states, int links, const SheaveMotion* sheaves, TipProbe* probes) const noexcept;

private:
    RigidModel model_;
    mutable RigidColumns columns_, strip_;
    mutable RigidForces forces_;
};

}  // namespace cvtflow::model
