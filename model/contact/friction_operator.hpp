#pragma once
/// Friction as an operator on velocities, with the kernels of one order and one instruction set.

#include <array>
#include <memory>
#include <type_traits>

#include "model/chain/chain_model.hpp"
#include "model/contact/contact_field.hpp"
#include "model/contact/friction_stage.hpp"

namespace cvtflow::model {

/// Inverse of a mass matrix of a link, by its symmetries: both ends are alike, and so are both halves of the pins' length.
/// [[a, b], [b, a]] acts on the sum of both ends as a + b and on their difference as a - b; modes of even and of odd order do not couple.
template <class Number>
struct MirroredInverseOf {
    std::array<Number, max_lateral * max_lateral> sum{}, difference{};  ///< (a ± b)/2, rows max_lateral apart; where m + k is odd: 0
};
using MirroredInverse = MirroredInverseOf<double>;

/// Slower sliding counts as this in single precision: its square is still a float, and so is one over it [m/s].
inline constexpr double slowest_single = 1e-15;

/// Constants of friction in the precision of its velocities.
template <class Number>
struct FrictionNumbers {
    explicit FrictionNumbers(const ChainModel& chain);

    FrictionCurve joint, plate, tip;
    std::shared_ptr<const TipLaw> tip_law;                                       ///< nullptr: none
    std::array<Number, max_joint_lanes> joint_position{};                        ///< ξ [1]
    std::array<std::array<Number, max_joint_lanes>, max_lateral> joint_basis{};  ///< P_m(ξ)
    std::array<Number, max_plate_lanes> plate_position{};                        ///< ξ [1]
    MirroredInverseOf<Number> lateral, axial;                                    ///< of x, and of y; of z and e
};

class FrictionOperator;

template <class Number>
struct FrictionSweepOf;  // model/contact/sweep_step.hpp
struct FrictionPowers;   // likewise

/// to = from + by · along, of the state of `links` links.
using LinkAdvance = void(const double* from, const double* along, double by, double* to, int links) noexcept;

/// Functions of implicit sweeps, and of a step's middle and end, of one order and one instruction set, in the precision of the velocities.
template <class Number>
struct SweepKernels {
    void (*sweep)(const FrictionOperator&, const ContactFieldOf<Number>&, const FrictionRangeOf<Number>&,
                  const FrictionSweepOf<Number>&) noexcept = nullptr;
    /// Powers of the kept forces at the range's velocities. powers [links of the range]
    void (*powers)(const FrictionOperator&, const ContactFieldOf<Number>&, const FrictionRangeOf<Number>&, const ColumnsOf<Number>& kept,
                   FrictionPowers* powers) noexcept = nullptr;
    /// @return whether the state of all links at the end is sound
    bool (*end)(const StepEndOf<Number>&, int links) noexcept = nullptr;
    LinkAdvance* advance = nullptr;
    /// @param links neighbouring ones that are to have the mean friction of the tips in their loads
    void (*react)(const TipReactionsOf<Number>&, int links) noexcept = nullptr;
};

/// Functions of one order and one instruction set.
struct FrictionKernels {
    using Record = void (*)(const FrictionOperator&, const ChainRange&, const ContactDrift&, ContactField&, Columns&, LinkLoad*,
                            TipSearch*) noexcept;
    using Evaluate = void (*)(const FrictionOperator&, const ContactField&, const FrictionRange&, const FrictionStage&) noexcept;
    Record record;
    Evaluate slopes, all_sticking;
    SweepKernels<double> sweeps;
};

/// FrictionKernels in single precision.
struct SingleFrictionKernels {
    using Record = void (*)(const FrictionOperator&, const ChainRange&, const ContactDrift&, const SinglePrecisionRecord&, LinkLoad*,
                            TipSearch*) noexcept;
    using Evaluate = void (*)(const FrictionOperator&, const ContactFieldOf<float>&, const FrictionRangeOf<float>&,
                              const FrictionStageOf<float>&) noexcept;
    Record record = nullptr;
    Evaluate slopes = nullptr, all_sticking = nullptr;
    SweepKernels<float> sweeps;
};

/// Friction as a function of velocities, for fields that record() has written. Velocities, forces and slopes of links are
/// [link_size()][stride] columns that begin at a range's first link - 1.
class FrictionOperator {
public:
    /// make_friction() (model/variator/variator.hpp) makes one with the kernels of the chain's instruction set.
    FrictionOperator(const ChainModel& chain, bool by_phase, const FrictionKernels& kernels, const SingleFrictionKernels& single);

    /// Number of scratch numbers for a range of `links` links.
    template <class Number = double>
    [[nodiscard]] int scratch_size(int links) const noexcept {
        return scratch_rows(chain_.layout().lateral()) * joint_stride<Number>(links);
    }
    [[nodiscard]] static constexpr int scratch_rows(int lateral) noexcept { return 2 * lateral + 7; }

    /// Columns of a row of scratch.
    template <class Number = double>
    [[nodiscard]] static constexpr int joint_stride(int links) noexcept {
        constexpr int line = ColumnsOf<Number>::line;
        return (links + line) / line * line + line;
    }

    /// Notes the contacts of the links of a range, replaces their reactions on the sheaves by those of the normal forces alone, and gives
    /// the accelerations of the links by everything but friction, in one pass over them: to rows of `frictionless`, column = link +
    /// range.shift. Ghost columns are written with the links that they repeat, if the range requires it.
    /// @param loads of the range's first link on   @param search nullptr: tips touch as the range's phases state
    void record(const ChainRange& range, const ContactDrift& drift, ContactField& field, Columns& frictionless, LinkLoad* loads,
                TipSearch* search = nullptr) const noexcept {
        kernels_.record(*this, range, drift, field, frictionless, loads, search);
    }
    /// record() for friction in single precision.
    void record(const ChainRange& range, const ContactDrift& drift, const SinglePrecisionRecord& start, LinkLoad* loads,
                TipSearch* search = nullptr) const noexcept {
        single_.record(*this, range, drift, start, loads, search);
    }
    /// slope = base + A⁻¹ friction(velocity) of links first … last - 1, and what the stage makes of it.
    void slopes(const ContactField& field, const FrictionRange& range, const FrictionStage& stage) const noexcept {
        kernels_.slopes(*this, field, range, stage);
    }
    void slopes(const ContactFieldOf<float>& field, const FrictionRangeOf<float>& range,
                const FrictionStageOf<float>& stage) const noexcept {
        single_.slopes(*this, field, range, stage);
    }
    /// slopes() for friction linearised where every contact sticks, about rest, and without base: the steepest the law can be.
    void all_sticking(const ContactField& field, const FrictionRange& range, Columns& slope) const noexcept {
        kernels_.all_sticking(*this, field, range, {nullptr, &slope});
    }
    void all_sticking(const ContactFieldOf<float>& field, const FrictionRangeOf<float>& range, ColumnsOf<float>& slope) const noexcept {
        single_.all_sticking(*this, field, range, {nullptr, &slope});
    }

    template <class Number>
    [[nodiscard]] const SweepKernels<Number>& sweeps() const noexcept {
        if constexpr (std::is_same_v<Number, float>) {
            return single_.sweeps;
        } else {
            return kernels_.sweeps;
        }
    }

    [[nodiscard]] const ChainModel& chain() const noexcept { return chain_; }
    /// Coefficients of the chain without friction.
    [[nodiscard]] const Coefficients& frictionless() const noexcept { return frictionless_; }
    /// Whether the branch of the law is that of the tip's phase (detail.stick_slip).
    [[nodiscard]] bool by_phase() const noexcept { return by_phase_; }
    [[nodiscard]] const MirroredInverse& lateral_inverse() const noexcept { return numbers_.lateral; }
    [[nodiscard]] const MirroredInverse& axial_inverse() const noexcept { return numbers_.axial; }
    /// Constants in the precision of the velocities.
    template <class Number>
    [[nodiscard]] const FrictionNumbers<Number>& numbers() const noexcept {
        if constexpr (std::is_same_v<Number, float>) {
            return single_numbers_;
        } else {
            return numbers_;
        }
    }

private:
    const ChainModel& chain_;
    Coefficients frictionless_;
    FrictionNumbers<double> numbers_;
    FrictionNumbers<float> single_numbers_;
    bool by_phase_;
    FrictionKernels kernels_;
    SingleFrictionKernels single_;
};

}  // namespace cvtflow::model
