#pragma once
/// Every friction contact of the chain with all frozen but velocities, laid out component by component so that lanes can run over links:
/// [component][column], column = link + 1; column 0 repeats the last link, column links + 1 the first. (With whole pins
/// three columns on each side do, and a column is a pin and the link behind which it lies.)

#include <array>
#include <cstddef>
#include <vector>

#include "model/basis/aligned.hpp"
#include "model/chain_model.hpp"

namespace cvtflow::model {

/// Numbers of the components of a contact field.
struct ContactComponents {
    int joint_points;  ///< integration points of a joint
    int plates;        ///< plates of a link

    /// Frame of the link: t_x, t_y, 1/|d0|.
    static constexpr int frame_x = 0, frame_y = 1, inverse_length = 2;
    /// Of one joint point; the joint is that of the link's rear pin.
    struct Joint {
        static constexpr int normal_x = 0, normal_y = 1, lever_before = 2, lever_after = 3, grip = 4, count = 5;
    };
    /// Of one tip; drift: change of the sheave's velocity where the tip touches, over the step, along with the tip.
    struct Tip {
        static constexpr int normal = 0, lever_x = 3, lever_y = 4, sheave = 5, drift = 8, grip = 11, least = 12, most = 13, count = 14;
    };
    [[nodiscard]] constexpr int joint(int point) const noexcept { return 3 + Joint::count * point; }
    /// μN of a plate [N].
    [[nodiscard]] constexpr int plate(int number) const noexcept { return joint(joint_points) + number; }
    [[nodiscard]] constexpr int tip(int corner) const noexcept { return plate(plates) + Tip::count * corner; }
    [[nodiscard]] constexpr int count() const noexcept { return tip(tips_per_link); }
};

/// Columns of doubles, one row per component, rows on cache lines of their own. Column 1, where links begin, begins a cache line.
class Columns {
public:
    /// Numbers that may be read and written before column 0.
    static constexpr int before_first = 7;

    Columns() = default;
    Columns(int components, int columns);

    [[nodiscard]] double* at(std::ptrdiff_t component, std::ptrdiff_t column) noexcept { return data() + component * stride_ + column; }
    [[nodiscard]] const double* at(std::ptrdiff_t component, std::ptrdiff_t column) const noexcept {
        return data() + component * stride_ + column;
    }
    [[nodiscard]] int stride() const noexcept { return static_cast<int>(stride_); }
    [[nodiscard]] const double* data() const noexcept { return memory_.data() + before_first; }
    [[nodiscard]] double* data() noexcept { return memory_.data() + before_first; }

private:
    LineVector<double> memory_;
    std::ptrdiff_t stride_ = 0;
};

/// Arms from a sheave's origin to the contact points of a link's tips, for reactions on the sheaves [m].
struct TipArms {
    double x[tips_per_link], y[tips_per_link], z[tips_per_link];
};

struct ContactField {
    explicit ContactField(const ChainModel& chain);

    ContactComponents components;
    Columns columns;
    std::vector<TipArms> arms;  ///< [links], where a tip touches
};

/// Inverse of a mass matrix of a link, by its symmetries: both ends are alike, and so are both halves of the pins' length.
/// [[a, b], [b, a]] acts on the sum of both ends as a + b and on their difference as a - b; modes of even and of odd order do not couple.
struct MirroredInverse {
    std::array<double, most_lateral * most_lateral> sum{}, difference{};  ///< (a ± b)/2, rows most_lateral apart; where m + k is odd: 0
};

class FrictionOperator;

struct FrictionRange {
    int first, last;         ///< links [first, last)
    const double* velocity;  ///< [link_size()][stride] of links first - 1 … last
    std::ptrdiff_t stride;   ///< of velocity
    double* scratch;         ///< FrictionOperator::scratch_size(last - first) [m/s, N]
    const Phase* phases;     ///< [links * 4], of the whole chain
    double time;             ///< of the velocities, from the middle of the step, in steps [1]
};

/// Accelerations by everything but friction, linear in time: now + lean (now - before). Columns over links (column = link + 1).
struct FrictionBase {
    const Columns* now;
    const Columns* before;
    double lean;  ///< share of the change since the last step [1]
};

/// Velocities that a table combines from others and from the slope just evaluated: Σ weight from + slope_weight slope, in this order.
struct VelocityRow {
    static constexpr std::size_t most_terms = 4;
    std::array<const Columns*, most_terms> from{};
    std::array<double, most_terms> weight{};  ///< [1]
    std::size_t terms = 0;
    double slope_weight = 0.0;  ///< [s]
    Columns* to = nullptr;      ///< none of `from`, nor the columns evaluated

    /// factor [1]
    void add(const Columns& columns, double factor) noexcept {
        from[terms] = &columns;
        weight[terms++] = factor;
    }
};

/// What an evaluation of friction is for: its slopes alone, or a row of a table. Columns over links (column = link + 1), all of the same
/// shape.
struct FrictionStage {
    const FrictionBase* base = nullptr;
    Columns* slope = nullptr;           ///< may be absent from a row
    const VelocityRow* next = nullptr;  ///< with base, or neither
    double weight = 0.0;                ///< of the tips' forces in impulses [1]
    Columns* impulses = nullptr;        ///< [3 tips_per_link] rows: x, y, z of each tip
};

/// What a field has to know of the step in whose middle it is recorded.
struct ContactDrift {
    double step = 0.0;         ///< h [s]
    SheaveMotion change[4]{};  ///< of the sheaves' velocities over the step
};

/// Functions of one order and one instruction set.
struct FrictionKernels {
    using Record = void (*)(const ChainModel&, const ChainRange&, const ContactDrift&, ContactField&, LinkLoad*) noexcept;
    using Push = void (*)(const FrictionOperator&, const ChainRange&, const ContactDrift&, ContactField&, Columns&, LinkLoad*) noexcept;
    using Evaluate = void (*)(const FrictionOperator&, const ContactField&, const FrictionRange&, const FrictionStage&) noexcept;
    Record record;
    Push push;
    Evaluate slopes, steepest;
};

/// Friction as a function of velocities, for fields that record() has written. Velocities, forces and slopes of links are
/// [link_size()][stride] columns that begin at a range's first link - 1.
class FrictionOperator {
public:
    FrictionOperator(const ChainModel& chain, bool by_phase);

    /// Doubles of scratch for a range of so many links.
    [[nodiscard]] int scratch_size(int links) const noexcept;

    /// Columns of a joint's rows in scratch.
    [[nodiscard]] static constexpr int joint_stride(int links) noexcept { return (links + 1 + 7) / 8 * 8 + 8; }

    /// Notes the contacts of the links of a range, and replaces their reactions on the sheaves by those of the normal forces alone.
    /// Ghost columns are written with the links that they repeat.
    /// @param loads of the range's first link on
    void record(const ChainRange& range, const ContactDrift& drift, ContactField& field, LinkLoad* loads) const noexcept {
        kernels_.record(chain_, range, drift, field, loads);
    }
    /// record(), and the accelerations of the range's links by everything but friction, in one pass over them: to rows of push, column =
    /// link + 1.
    void record_and_push(const ChainRange& range, const ContactDrift& drift, ContactField& field, Columns& push,
                         LinkLoad* loads) const noexcept {
        kernels_.push(*this, range, drift, field, push, loads);
    }
    /// slope = base + A⁻¹ friction(velocity) of links first … last - 1, and what the stage makes of it.
    void slopes(const ContactField& field, const FrictionRange& range, const FrictionStage& stage) const noexcept {
        kernels_.slopes(*this, field, range, stage);
    }
    /// slopes() for friction linearised where every contact sticks, about rest, and without base: the steepest the law can be.
    void steepest(const ContactField& field, const FrictionRange& range, Columns& slope) const noexcept {
        kernels_.steepest(*this, field, range, {nullptr, &slope});
    }

    [[nodiscard]] const ChainModel& chain() const noexcept { return chain_; }
    /// Those of the chain without friction.
    [[nodiscard]] const Coefficients& frictionless() const noexcept { return frictionless_; }
    /// Whether the branch of the law is that of the tip's phase (detail.stick_slip).
    [[nodiscard]] bool by_phase() const noexcept { return by_phase_; }
    [[nodiscard]] const MirroredInverse& lateral_inverse() const noexcept { return lateral_inverse_; }
    [[nodiscard]] const MirroredInverse& axial_inverse() const noexcept { return axial_inverse_; }

private:
    const ChainModel& chain_;
    Coefficients frictionless_;
    MirroredInverse lateral_inverse_;  ///< of x, and of y; with whole pins neither is needed
    MirroredInverse axial_inverse_;    ///< of z and e
    bool by_phase_;
    FrictionKernels kernels_;
};

}  // namespace cvtflow::model
