#pragma once
/// Friction as an operator on velocities, with the kernels of one instruction set.

#include <array>
#include <memory>

#include "model/chain/chain_model.hpp"
#include "model/contact/contact_field.hpp"
#include "model/machine/held_links.hpp"

namespace cvtflow::model {

/// Constants of friction as floats, in which velocities inside a step are computed.
struct FrictionNumbers {
    FrictionNumbers(const Coefficients& coefficients, const HeldInverse& responses);

    double joint_saturation, plate_saturation, tip_saturation;  ///< speeds from which friction has its full strength [m/s]
    std::shared_ptr<const TipLaw> tip_law;                      ///< nullptr: none
    PointLanes<max_joint_lanes, float> joint_points;
    PointLanes<max_plate_lanes, float> plates;
    HeldNumbers<float> inverse;

    [[nodiscard]] bool filter_waves() const noexcept { return inverse.wave_joint[0] > 0.0F; }
};

class FrictionOperator;

struct FrictionSweep;   // model/contact/sweep_step.hpp
struct FrictionPowers;  // model/contact/sweep_step.hpp

/// Advances links: to = from + by · along, of the state of `links` links.
using LinkAdvance = void(const double* from, const double* along, double by, double* to, int links) noexcept;

/// Functions of friction, and of a step's middle and end, of one instruction set.
struct FrictionKernels {
    void (*record)(const FrictionOperator&, const ChainRange&, const ContactDrift&, const ContactRecord&, LinkLoad*, TipSearch*) noexcept;
    void (*sweep)(const FrictionOperator&, const ContactField&, const FrictionRange&, const FrictionSweep&) noexcept;
    /// Powers of the kept forces at the range's velocities. powers [links of the range]
    void (*powers)(const FrictionOperator&, const ContactField&, const FrictionRange&, const FloatColumns& kept,
                   FrictionPowers* powers) noexcept;
    /// @return whether the state of all links at the end is sound
    bool (*end)(const StepEnd&, int links) noexcept;
    LinkAdvance* advance;
    /// @param links neighbouring ones that are to have the mean friction of the tips in their loads
    void (*react)(const TipReactions&, int links) noexcept;
};

/// Friction as a function of velocities, for fields that record() has written. Velocities, forces and slopes of links are
/// [link_size()][stride] columns that begin at a range's first link - 1.
class FrictionOperator {
public:
    /// make_friction() (model/variator/variator.hpp) makes one with the kernels of the chain's instruction set.
    FrictionOperator(const ChainModel& chain, const FrictionKernels& kernels);

    /// Number of scratch numbers for a range of `links` links: rows of the forces of its joints (JointContacts).
    [[nodiscard]] int scratch_size(int links) const noexcept { return scratch_rows(chain_.layout().lateral()) * joint_stride(links); }
    [[nodiscard]] static constexpr int scratch_rows(int lateral) noexcept { return 2 * lateral + 4; }

    /// Columns of a row of scratch.
    [[nodiscard]] static constexpr int joint_stride(int links) noexcept {
        constexpr int line = FloatColumns::line;
        return (links + line) / line * line + line;
    }

    /// Records the contacts of a range of links, in one pass: the reactions on the sheaves become those of the normal forces alone. Writes
    /// the accelerations without friction, and the velocities at the step's beginning, to rows of the record's columns, column = link +
    /// range.shift. The frames of one link on each side of the range are recorded, too, and the joint of that behind it.
    /// @param loads of the range's first link on   @param search nullptr: tips touch as the range's phases state
    void record(const ChainRange& range, const ContactDrift& drift, const ContactRecord& to, LinkLoad* loads,
                TipSearch* search = nullptr) const noexcept {
        kernels_.record(*this, range, drift, to, loads, search);
    }
    [[nodiscard]] const FrictionKernels& kernels() const noexcept { return kernels_; }

    /// Holds links from now on, as a step of this length does: what record() gives, and how velocities respond to forces.
    /// @param step rounded, so that the rounding of times renews nothing [s]
    void hold(float step) noexcept;

    [[nodiscard]] const ChainModel& chain() const noexcept { return chain_; }
    /// Inverse by which velocities respond to forces.
    [[nodiscard]] const HeldInverse& inverse() const noexcept { return inverse_; }
    [[nodiscard]] const FrictionNumbers& numbers() const noexcept { return numbers_; }

private:
    const ChainModel& chain_;
    HeldInverse inverse_;
    float held_for_ = 0.0F;  ///< step that inverse_ holds links for; 0: none is held [s]
    FrictionNumbers numbers_;
    FrictionKernels kernels_;
};

}  // namespace cvtflow::model
