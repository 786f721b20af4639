#pragma once
/// Columns of a chain of rigid pins: structs of arrays by subject, pins side by side in each row. Entry i of a row belongs to pin i, or
/// where so said to link i between the pins i and i+1. (model/EQUATIONS.md section 11; symbols as there)

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <type_traits>

#include "model/basis/columns.hpp"

namespace cvtflow::model {

/// Pins that a kernel computes side by side; the same for every instruction set, so that sums have the same order.
inline constexpr int rigid_lanes = 8;
inline constexpr int rigid_coordinates = 8;  ///< coordinates per pin: x, y, z, p, q, ζ and two of bending
inline constexpr int rigid_tips = 4;         ///< tips per pin: front half at -z and +z, rear half at -z and +z
inline constexpr double far_depth = -1.0;    ///< depth of tips that are far from any sheave [m]

/// Memory that tips need between their normal forces and their friction: for the chain and for each eight pins [bytes].
inline constexpr std::size_t held_at_least = 8192, held_per_block = 16384;

template <class Number>
struct PlaneRowOf {
    Number *x, *y;
};

/// Rows that follow each other in memory.
template <class Number>
struct RowRange {
    RowRange(Number* only) noexcept : first(only), last(only) {}
    RowRange(Number* from, Number* to) noexcept : first(from), last(to) {}
    Number *first, *last;
};

/// Coordinates of a pin, their rates, or forces on them [m], [m/s], [m/s²], [N].
template <class Number>
struct CoordinateRowsOf {
    PlaneRowOf<Number> middle;  ///< x, y of the middle Q
    Number* z;                  ///< z of the middle
    PlaneRowOf<Number> end;     ///< p = D_x, q = D_y: end at +z against the middle
    Number* slide;              ///< ζ: z of the front half less z of the rear half
    PlaneRowOf<Number> bend;    ///< both ends by bending
    [[nodiscard]] std::array<Number*, rigid_coordinates> all() const noexcept {
        return {middle.x, middle.y, z, end.x, end.y, slide, bend.x, bend.y};
    }
    [[nodiscard]] RowRange<Number> rows() const noexcept { return {middle.x, bend.y}; }
};

/// The rows of a chain, of numbers of one type. A step has floats behind a state in doubles: what takes a difference of a length or place
/// reads the state, and everything else the copies of it that `drift` leaves.
template <class Real>
struct RigidRowsOf {
    using Row = Real*;  ///< entry of pin 0; entries -1 … padded() + lanes - 1 exist
    using PlaneRow = PlaneRowOf<Real>;
    using CoordinateRows = CoordinateRowsOf<Real>;
    using TipRow = std::array<Row, rigid_tips>;
    using Range = RowRange<Real>;

    /// Constants of a link; yaw and torsion against displacements of the ends, shear against an angle.
    struct LinkConstantRows {
        Row free_length;        ///< ℓ_0 [m]
        Row inverse_length;     ///< 1/ℓ_0 [1/m]
        Row yaw_stiffness;      ///< k_ψ [N/m]
        Row yaw_damping;        ///< d_ψ [N·s/m]
        Row shear_stiffness;    ///< k_γ [N·m]
        Row shear_damping;      ///< d_γ [N·m·s]
        Row torsion_stiffness;  ///< k_χ [N/m]
        Row torsion_damping;    ///< d_χ [N·s/m]
        Row longer;             ///< λ: excess of half the pin's length over ℓ_p/2 [m]
    };

    /// Pitch line of a link.
    struct PitchLineRows {
        PlaneRow direction;  ///< t
        Row inverse;         ///< 1/ℓ [1/m]
        Row turn;            ///< θ': turning rate [rad/s]
        Row turn_ahead;      ///< θ' at the time of the coordinates, extrapolated from this step and the last one [rad/s]
        [[nodiscard]] Range rows() const noexcept { return {direction.x, turn_ahead}; }
    };

    /// Rolling of the halves of a pin on each other.
    struct RollingRows {
        PlaneRow bisector;      ///< b: direction of the bisector of both pitch lines
        Row along;              ///< factor of f in A f [m]
        Row across;             ///< factor of b (b·f) in A f [m]
        PlaneRow offset;        ///< u: front half against rear half [m]
        PlaneRow offset_rate;   ///< u' [m/s]
        PlaneRow offset_ahead;  ///< u' by turn_ahead [m/s]
        [[nodiscard]] Range rows() const noexcept { return {bisector.x, offset_ahead.y}; }
    };

    /// Forces of a link on its front half. The rear half has the opposite; of shear the same.
    struct LinkForceRows {
        PlaneRow pull;   ///< force on the middle [N]
        Row pull_z;      ///< force on the middle along z [N]
        PlaneRow twist;  ///< yaw and torsion, generalised force on p, q [N]
        PlaneRow shear;  ///< shear, generalised force on p, q [N]
        PlaneRow bow;    ///< opposite of the generalised force on bending [N]
        [[nodiscard]] Range rows() const noexcept { return {pull.x, bow.y}; }
    };

    /// Forces by which the filter of the waves knows how the links' deflections accelerate (rigid_links.hpp).
    struct WaveRows {
        PlaneRow force;      ///< force on a pin's middle by links, and by tips as they last [N]
        PlaneRow end_force;  ///< the same on p and q [N]
        PlaneRow tips;       ///< low pass of the tips' force on the middle [N]
        PlaneRow end_tips;   ///< low pass of their force on p and q [N]
        [[nodiscard]] Range forces() const noexcept { return {force.x, end_force.y}; }
        [[nodiscard]] Range lasting() const noexcept { return {tips.x, end_tips.y}; }
    };

    /// Damping forces, kept for the loss of the next step.
    struct DampingRows {
        Row stretch;         ///< force against the rate ε' of a link's plates [N]
        Row yaw;             ///< force against the rate ψ' of a link [N]
        Row torsion;         ///< force against the rate χ' of a link [N]
        Row shear;           ///< moment against the rate γ' of a link [N·m]
        Row bow;             ///< force against the bow rate of a link [N]
        Row bend_along;      ///< force against the rate of a pin's bending along the travel [N]
        Row bend_across;     ///< force against the rate of a pin's bending across the travel [N]
        Row guide;           ///< force of a guide against a pin's approach [N]
        Row guide_friction;  ///< force of a guide against a pin's speed along the strand [N]
        Row wave;            ///< force of the filter of the waves against the rate of a pitch line's length [N]
        Row wave_yaw;        ///< force of this filter against the rate of a link's yaw [N]
        [[nodiscard]] Range rows() const noexcept { return {stretch, wave_yaw}; }
        [[nodiscard]] Range waves() const noexcept { return {wave, wave_yaw}; }
    };

    /// Joint between the halves of a pin, and the friction between them along z.
    struct JointRows {
        PlaneRow offset_moment;  ///< A g of the links' forces [N·m]
        Row rolling_moment;      ///< resistance to rolling [N·m]
        Row bend_moment;         ///< moment of a pin's bending on each of its two pitch lines [N·m]
        Row normal;              ///< N_j: normal force between the halves [N]
        Row friction;            ///< J: friction against ζ' [N]
        Row friction_before;     ///< J of the last step [N]
        Row slip;                ///< ζ' when friction acts [m/s]
        Row slip_before;         ///< slip of the last step [m/s]
        Row free_slip;           ///< ζ' without this friction [m/s]
        Row secant;              ///< friction per free sliding speed [N·s/m]
        Row coupling;            ///< β: share of a force parting the halves that friction between them takes, 0 … 1
        Row axial_free_speed;    ///< z' without friction of plates [m/s]
    };

    /// Friction between the plates of link i and its pins along z. Low and high: half of the plates each, at -z and at +z.
    struct PlateRows {
        Row tension;           ///< T: tension of all plates, with damping [N]
        Row friction;          ///< P: friction of all plates [N]
        Row moment;            ///< Π: friction of the plates at +z less that of those at -z [N]
        Row friction_before;   ///< P of the last step [N]
        Row moment_before;     ///< Π of the last step [N]
        Row slip_low;          ///< sliding speed when friction acts [m/s]
        Row slip_high;         ///< sliding speed when friction acts [m/s]
        Row slip_low_before;   ///< slip_low of the last step [m/s]
        Row slip_high_before;  ///< slip_high of the last step [m/s]
        Row free_slip;         ///< sliding speed without plate friction [m/s]
        Row secant_high;       ///< friction per sliding speed of the plates at +z [N·s/m]
        // Equations of the friction (RingRows), link by link.
        Row rhs;            ///< B: friction of the free sliding speeds [N]
        Row own, back, on;  ///< factors of P of this link, of the link behind and of the one ahead
    };

    /// Tips of a pin together. Depth holds for velocities as they are (RigidKick), too.
    struct TipRows {
        Row near;      ///< > 0: the pin may touch until near pins are found again
        Row blocks;    ///< entry 0: time for which they are valid [s]; then 1 + first pin of each block of eight that is computed, and 0
        TipRow depth;  ///< δ_0: depth of each tip, `far_depth` of pins that certainly do not touch [m]
        PlaneRow offset_moment;  ///< A g of the tips' forces [N·m]
        Row moment_of_half[2];   ///< moment of the front half's tips on the pitch line behind the pin, of the rear half's ahead [N·m]
        Row moment;              ///< moment of all tips on pitch line i [N·m]
        CoordinateRows force;    ///< forces of a pin's tips on it
        Row lengthening;         ///< e': outward velocity of an end against the middle as the pin lengthens, mean of halves and ends [m/s]
        TipRow normal;           ///< N: normal force [N]
        TipRow damping_force;    ///< damping part of the normal force [N]
        TipRow tangential;       ///< friction on the pin along the circumference [N]
        TipRow radial;           ///< friction on the pin along the flank [N]
        TipRow grip;             ///< friction per sliding speed, behind the friction of the step [N·s/m]
        // For observation.
        TipRow sheave_outward;    ///< force on the sheave, away from its axis [N]
        TipRow sheave_axial;      ///< force on the sheave along z [N]
        TipRow radius;            ///< distance from the axis [m]
        TipRow touching;          ///< 1 where the tip was last found to press, else 0
        TipRow remembered_speed;  ///< w: sliding speed that the friction of a tip follows by a law with memory [m/s]
        [[nodiscard]] Range moments() const noexcept { return {offset_moment.x, moment_of_half[1]}; }
        [[nodiscard]] Range forces() const noexcept { return {normal[0], radial[3]}; }
        [[nodiscard]] Range remembered() const noexcept { return {remembered_speed[0], remembered_speed[3]}; }
        /// Rows that are cleared at a pin that is no longer near, in two parts.
        [[nodiscard]] std::array<Range, 2> written_rows() const noexcept { return {moments(), Range{force.middle.x, radius[3]}}; }
    };

    CoordinateRowsOf<double> state_position, state_velocity;
    CoordinateRows position, velocity;  ///< the state that `drift` leaves, rounded
    CoordinateRows acceleration;
    LinkConstantRows constants;
    PitchLineRows line;
    RollingRows rolling;
    LinkForceRows link;
    WaveRows wave;
    DampingRows damping;
    JointRows joint;
    CoordinateRows force;  ///< forces on a pin by links and its bending, without friction along it
    PlateRows plate;
    RingRows<Real> ring;  ///< equations of `plate`
    TipRows tip;
};

/// All rows; each has copies of its cyclic neighbours in front (one) and behind (a vector). A constant object has the same rows, whose
/// numbers may change.
template <class Real>
class RigidColumnsOf : public RigidRowsOf<Real> {
public:
    using Rows = RigidRowsOf<Real>;
    using typename Rows::Range;
    using typename Rows::Row;

    explicit RigidColumnsOf(int pins)
        : pins_(pins),
          padded_((pins + rigid_lanes - 1) / rigid_lanes * rigid_lanes),
          stride_(padded_ + 2 * rigid_lanes),
          state_(state_rows * static_cast<std::size_t>(stride_), 0.0),
          memory_((row_count - state_rows) * static_cast<std::size_t>(stride_), Real(0)),
          held_(held_at_least + static_cast<std::size_t>(padded_ / rigid_lanes) * held_per_block) {
        std::array<void*, row_count> rows;
        const auto place = [&](std::size_t row) { return static_cast<std::ptrdiff_t>(row) * stride_ + rigid_lanes; };
        for (std::size_t k = 0; k < state_rows; ++k) rows[k] = state_.data() + place(k);
        for (std::size_t k = state_rows; k < row_count; ++k) rows[k] = memory_.data() + place(k - state_rows);
        std::memcpy(static_cast<Rows*>(this), rows.data(), sizeof(Rows));
    }
    RigidColumnsOf(const RigidColumnsOf& other) : RigidColumnsOf(other.pins_) { assign(other); }
    RigidColumnsOf& operator=(const RigidColumnsOf&) = delete;

    /// All numbers of columns of as many pins, rounded.
    template <class Number>
    void assign(const RigidColumnsOf<Number>& from) noexcept {
        std::copy(from.state_.begin(), from.state_.end(), state_.begin());
        std::transform(from.memory_.begin(), from.memory_.end(), memory_.begin(), [](Number v) { return static_cast<Real>(v); });
    }

    [[nodiscard]] int pins() const noexcept { return pins_; }
    /// Pins including those that fill the last vector, which are copies of the first.
    [[nodiscard]] int padded() const noexcept { return padded_; }

    /// Renews the copies of neighbours; kernels have a function that does it by vectors.
    template <class Number>
    void wrap(const RowRange<Number>& rows) const noexcept {
        for (Number* values = rows.first; values <= rows.last; values += stride_) {
            values[-1] = values[pins_ - 1];
            for (int k = pins_; k < pins_ + rigid_lanes; ++k) values[k] = values[k - pins_];
        }
    }

    /// Zeros to entries i … i + count - 1.
    [[gnu::always_inline]] void clear(const Range& rows, int i, int count) const noexcept {
        for (Row values = rows.first; values <= rows.last; values += stride_) {
            for (int k = 0; k < count; ++k) values[i + k] = Real(0);
        }
    }

    /// Zeros to the numbers of all tips that a step writes.
    void clear_tips() const noexcept {
        for (const Range& part : this->tip.written_rows()) clear(part, 0, padded_ + rigid_lanes);
    }

    /// All entries of rows to others.
    void copy(const Range& from, Row to) const noexcept {
        std::copy_n(from.first - rigid_lanes, from.last - from.first + stride_, to - rigid_lanes);
    }

    [[nodiscard]] int stride() const noexcept { return stride_; }
    [[nodiscard]] std::size_t bytes() const noexcept {
        return state_.size() * sizeof(double) + memory_.size() * sizeof(Real) + held_.size();
    }
    /// Memory of the tips between their normal forces and their friction (rigid_tips.hpp).
    [[nodiscard]] std::byte* held() const noexcept { return held_.data(); }

    /// Rows that the pins keep from step to step, beside the state.
    [[nodiscard]] std::array<Range, 10> kept() const noexcept {
        return {this->damping.rows(),
                this->wave.lasting(),
                this->line.turn,
                this->joint.rolling_moment,
                this->acceleration.rows(),
                Range{this->plate.friction, this->plate.slip_high_before},
                Range{this->joint.friction, this->joint.slip_before},
                this->tip.blocks,
                this->tip.moment,
                this->tip.forces()};
    }
    [[nodiscard]] RowRange<double> state() const noexcept { return {this->state_position.middle.x, this->state_velocity.bend.y}; }

private:
    template <class Number>
    friend class RigidColumnsOf;
    static constexpr std::size_t row_count = sizeof(Rows) / sizeof(Row), state_rows = 2 * rigid_coordinates;

    int pins_, padded_, stride_;
    LineVector<double> state_;
    LineVector<Real> memory_;
    mutable LineVector<std::byte> held_;
};
using RigidColumns = RigidColumnsOf<double>;
using StepColumns = RigidColumnsOf<float>;

}  // namespace cvtflow::model
