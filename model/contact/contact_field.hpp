#pragma once
/// Every friction contact of the chain with all frozen but velocities, laid out component by component so that lanes can run over links:
/// [component][column], column = link + 1; column 0 repeats the last link, column links + 1 the first. Of pins in halves only.
///
/// In double precision velocities are what they are. In single precision they count from those at which the contacts were recorded, so that
/// small differences of large velocities are taken in double precision, once a step; a field then also holds how contacts slide at those.

#include <array>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <vector>

#include "model/basis/columns.hpp"
#include "model/variator/chain_model.hpp"

namespace cvtflow::model {

/// Numbers of the components of a contact field.
struct ContactComponents {
    int joint_points;       ///< integration points of a joint
    int plates;             ///< plates of a link
    bool relative = false;  ///< velocities count from those at which contacts were recorded

    /// Frame of the link: t_x, t_y, 1/|d0|.
    static constexpr int frame_x = 0, frame_y = 1, inverse_length = 2;
    /// Of one joint point; the joint is that of the link's rear pin.
    struct Joint {
        static constexpr int normal_x = 0, normal_y = 1, lever_before = 2, lever_after = 3, friction_limit = 4, count = 5;
    };
    /// Of one tip; sheave: velocity of the sheave where the tip touches (if relative: of the sheave against the tip); drift: its change
    /// over the step, along with the tip.
    struct Tip {
        static constexpr int normal = 0, lever_x = 3, lever_y = 4, sheave = 5, drift = 8, friction_limit = 11, least = 12, most = 13,
                             count = 14;
    };
    [[nodiscard]] constexpr int joint(int point) const noexcept { return 3 + Joint::count * point; }
    /// μN of a plate [N].
    [[nodiscard]] constexpr int plate(int number) const noexcept { return joint(joint_points) + number; }
    [[nodiscard]] constexpr int tip(int corner) const noexcept { return plate(plates) + Tip::count * corner; }
    /// If relative, at the velocities that others count from: sliding of a joint's points across the axis, z and e of the joint's gap and
    /// of the gap between the link's pins [m/s].
    [[nodiscard]] constexpr int sliding(int point) const noexcept { return tip(tips_per_link) + point; }
    [[nodiscard]] constexpr int joint_gap() const noexcept { return sliding(joint_points); }
    [[nodiscard]] constexpr int plate_gap() const noexcept { return joint_gap() + 2; }
    [[nodiscard]] constexpr int count() const noexcept { return relative ? plate_gap() + 2 : tip(tips_per_link); }
};

/// Arms from a sheave's origin to the contact points of a link's tips, for reactions on the sheaves [m].
struct TipArms {
    double x[tips_per_link], y[tips_per_link], z[tips_per_link];
};

template <class Number>
struct ContactFieldOf {
    explicit ContactFieldOf(const ChainModel& chain);
    /// As many columns, of contacts that have never touched.
    void make_columns(int count);

    [[nodiscard]] std::size_t bytes() const noexcept { return columns.bytes() + arms.size() * sizeof(TipArms); }

    ContactComponents components;
    ColumnsOf<Number> columns;
    std::vector<TipArms> arms;  ///< [links], where a tip touches
};
using ContactField = ContactFieldOf<double>;

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
struct FrictionRangeOf {
    int first, last;         ///< links [first, last)
    const Number* velocity;  ///< [link_size()][stride] of links first - 1 … last
    std::ptrdiff_t stride;   ///< of velocity
    Number* scratch;         ///< FrictionOperator::scratch_size<Number>(last - first) [m/s, N]
    const Phase* phases;     ///< [links * 4], of the whole chain
    double time;             ///< of the velocities, from the middle of the step, in steps [1]
    int shift = 1;           ///< column of a link in all fields but velocity: its number + shift
};
using FrictionRange = FrictionRangeOf<double>;

/// Accelerations by everything but friction, linear in time: now + extrapolation (now - before). Columns over links (column = link + 1).
template <class Number>
struct FrictionBaseOf {
    const ColumnsOf<Number>* now;
    const ColumnsOf<Number>* before;
    double extrapolation;  ///< share of the change since the last step [1]
};

/// Velocities that a table combines from others and from the slope just evaluated: Σ weight from + slope_weight slope, in this order.
template <class Number>
struct VelocityRowOf {
    static constexpr std::size_t max_terms = 4;
    std::array<const ColumnsOf<Number>*, max_terms> from{};
    std::array<double, max_terms> weight{};  ///< [1]
    std::size_t terms = 0;
    double slope_weight = 0.0;        ///< [s]
    ColumnsOf<Number>* to = nullptr;  ///< none of `from`, nor the columns evaluated

    /// factor [1]
    void add(const ColumnsOf<Number>& columns, double factor) noexcept {
        from[terms] = &columns;
        weight[terms++] = factor;
    }
};
using VelocityRow = VelocityRowOf<double>;

/// What an evaluation of friction is for: its slopes alone, or a row of a table. Columns over links (column = link + 1), all of the same
/// shape.
template <class Number>
struct FrictionStageOf {
    const FrictionBaseOf<Number>* base = nullptr;
    ColumnsOf<Number>* slope = nullptr;           ///< may be absent from a row
    const VelocityRowOf<Number>* next = nullptr;  ///< with base, or neither
    double weight = 0.0;                          ///< of the tips' forces in impulses [1]
    ColumnsOf<Number>* impulses = nullptr;        ///< [3 tips_per_link] rows: x, y, z of each tip
};
using FrictionStage = FrictionStageOf<double>;

/// What a field has to know of the step in whose middle it is recorded.
struct ContactDrift {
    double step = 0.0;         ///< h [s]
    SheaveMotion change[4]{};  ///< of the sheaves' velocities over the step
};

/// What a pass over the links leaves of them for friction in single precision.
struct SinglePrecisionRecord {
    const double* states;  ///< [unknowns] at the step's beginning, of the range's first link on
    ContactFieldOf<float>& field;
    ColumnsOf<float>& frictionless;  ///< accelerations by everything but friction [m/s², rad/s²]
    ColumnsOf<float>& velocity;      ///< at the step's beginning, counted from those at which contacts are recorded [m/s, rad/s]
};

template <class Number>
struct FrictionSweepOf;  // model/contact/sweep_step.hpp
struct FrictionPowers;   // likewise

/// Functions of implicit sweeps of one order and one instruction set, in the precision of the velocities.
template <class Number>
struct SweepKernels {
    void (*sweep)(const FrictionOperator&, const ContactFieldOf<Number>&, const FrictionRangeOf<Number>&,
                  const FrictionSweepOf<Number>&) noexcept = nullptr;
    /// Of the kept forces at the range's velocities. powers [links of the range]
    void (*powers)(const FrictionOperator&, const ContactFieldOf<Number>&, const FrictionRangeOf<Number>&, const ColumnsOf<Number>& kept,
                   FrictionPowers* powers) noexcept = nullptr;
};

/// Functions of one order and one instruction set.
struct FrictionKernels {
    using Record = void (*)(const FrictionOperator&, const ChainRange&, const ContactDrift&, ContactField&, Columns&, LinkLoad*) noexcept;
    using Evaluate = void (*)(const FrictionOperator&, const ContactField&, const FrictionRange&, const FrictionStage&) noexcept;
    Record record;
    Evaluate slopes, all_sticking;
    SweepKernels<double> sweeps;
};

/// The same in single precision.
struct SingleFrictionKernels {
    using Record = void (*)(const FrictionOperator&, const ChainRange&, const ContactDrift&, const SinglePrecisionRecord&,
                            LinkLoad*) noexcept;
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
    FrictionOperator(const ChainModel& chain, bool by_phase);

    /// Numbers of scratch for a range of so many links.
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
    /// @param loads of the range's first link on
    void record(const ChainRange& range, const ContactDrift& drift, ContactField& field, Columns& frictionless,
                LinkLoad* loads) const noexcept {
        kernels_.record(*this, range, drift, field, frictionless, loads);
    }
    /// The same for friction in single precision.
    void record(const ChainRange& range, const ContactDrift& drift, const SinglePrecisionRecord& start, LinkLoad* loads) const noexcept {
        single_.record(*this, range, drift, start, loads);
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
    /// Those of the chain without friction.
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
