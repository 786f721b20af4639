#pragma once
/// Plane vectors of pins side by side, access to columns, sums over pins, and friction of a contact. (model/EQUATIONS.md section 11)

#include <algorithm>
#include <array>

#include "model/basis/ring_solver.hpp"
#include "model/law/friction_laws.hpp"
#include "model/rigid/rigid_kernels.hpp"

namespace cvtflow::model {

namespace {

/// Number type of the kernels in this source, and their columns: doubles of an instant, or floats of a step (rigid_step_kernels.cpp).
#ifndef CVTFLOW_RIGID_NUMBER
#define CVTFLOW_RIGID_NUMBER double
#endif
using PinReal = CVTFLOW_RIGID_NUMBER;
using PinColumns = RigidColumnsOf<PinReal>;
using Row = PinReal*;
using PlaneRow = PlaneRowOf<PinReal>;
constexpr bool in_step = std::is_same_v<PinReal, float>;

/// Width of the pins that a kernel computes side by side.
constexpr int pin_width = eight_of<PinReal>;
using PinLanes = Lanes<pin_width>;
/// Width of tips: of floats one vector of the processor, but at least one block of pins: roots and divisions take most of the time.
constexpr int tip_width = in_step && native_floats > rigid_lanes ? singles<native_floats> : pin_width;

template <int W>
struct PlaneOf {
    Lanes<W> x, y;
    friend PlaneOf operator+(const PlaneOf& a, const PlaneOf& b) noexcept { return {a.x + b.x, a.y + b.y}; }
    friend PlaneOf operator-(const PlaneOf& a, const PlaneOf& b) noexcept { return {a.x - b.x, a.y - b.y}; }
    friend PlaneOf operator*(const Lanes<W>& f, const PlaneOf& a) noexcept { return {f * a.x, f * a.y}; }
    friend Lanes<W> dot(const PlaneOf& a, const PlaneOf& b) noexcept { return a.x * b.x + a.y * b.y; }
    /// z component of the cross product.
    friend Lanes<W> cross(const PlaneOf& a, const PlaneOf& b) noexcept { return a.x * b.y - a.y * b.x; }
    /// k×a
    friend PlaneOf turned(const PlaneOf& a) noexcept { return {-a.y, a.x}; }
};
template <int W>
PlaneOf(Lanes<W>, Lanes<W>) -> PlaneOf<W>;
using Plane = PlaneOf<pin_width>;

/// Doubles, as many as a vector of width W has lanes.
template <int W>
using DoublesOf = Lanes<lane_count<W>>;
template <int W>
using DoublePlaneOf = PlaneOf<lane_count<W>>;

/// Converts doubles to the width W.
template <int W>
[[nodiscard, gnu::always_inline]] inline Lanes<W> convert(const DoublesOf<W>& v) noexcept {
    if constexpr (is_single<W>) {
        return narrow<lane_count<W>>(v);
    } else {
        return v;
    }
}
template <int W>
[[nodiscard, gnu::always_inline]] inline PlaneOf<W> convert(const DoublePlaneOf<W>& v) noexcept {
    return {convert<W>(v.x), convert<W>(v.y)};
}
/// Converts numbers of the width W to doubles.
template <int W>
[[nodiscard, gnu::always_inline]] inline DoublesOf<W> widened(const Lanes<W>& v) noexcept {
    if constexpr (is_single<W>) {
        return widen<lane_count<W>>(v);
    } else {
        return v;
    }
}

template <int W>
[[nodiscard, gnu::always_inline]] inline DoublePlaneOf<W> widened(const PlaneOf<W>& v) noexcept {
    return {widened<W>(v.x), widened<W>(v.y)};
}

/// Eight doubles as numbers of the columns.
[[nodiscard, gnu::always_inline]] inline PinLanes rounded(const Lanes<rigid_lanes>& v) noexcept { return convert<pin_width>(v); }
[[nodiscard, gnu::always_inline]] inline Plane rounded(const PlaneOf<rigid_lanes>& v) noexcept { return convert<pin_width>(v); }

/// Entries i … i + 7 of a row of floats or doubles.
template <class Number>
[[nodiscard, gnu::always_inline]] inline Lanes<eight_of<Number>> read(const Number* row, int i) noexcept {
    return load<eight_of<Number>>(row + i);
}
template <class Number>
[[nodiscard, gnu::always_inline]] inline PlaneOf<eight_of<Number>> read(const PlaneRowOf<Number>& rows, int i) noexcept {
    return {read(rows.x, i), read(rows.y, i)};
}
template <class Number>
[[gnu::always_inline]] inline void write(Number* row, int i, const Lanes<eight_of<Number>>& value) noexcept {
    value.copy_to(row + i);
}
[[gnu::always_inline]] inline void write(const PlaneRow& rows, int i, const Plane& value) noexcept {
    write(rows.x, i, value.x);
    write(rows.y, i, value.y);
}

/// RigidColumnsOf::wrap() by vectors.
template <class Number>
inline void wrap(const auto& columns, const RowRange<Number>& rows) noexcept {
    if (columns.pins() < rigid_lanes) return columns.wrap(rows);
    for (Number* values = rows.first; values <= rows.last; values += columns.stride()) {
        values[-1] = values[columns.pins() - 1];
        write(values, columns.pins(), read(values, 0));
    }
}
template <class Number>
inline void wrap(const auto& columns, Number* row) noexcept {
    wrap(columns, RowRange{row});
}

/// Vectors of pins i - 1 … i + 6, given those of pins i - 8 … i - 1 and i … i + 7.
[[nodiscard, gnu::always_inline]] inline Plane shifted_by_one_pin(const Plane& before, const Plane& now) noexcept {
    return {lanes_across<rigid_lanes - 1, pin_width>(before.x, now.x), lanes_across<rigid_lanes - 1, pin_width>(before.y, now.y)};
}

/// Power that a damping force dissipates; writes the force to its row. A velocity between two steps works with the mean of both steps'
/// forces.
[[nodiscard, gnu::always_inline]] inline PinLanes drag_power(const RigidKick& kick, Row row, int i, const PinLanes& force,
                                                             const PinLanes& rate) noexcept {
    const PinLanes acting = kick.implicit() ? 0.5 * (force + read(row, i)) : force;
    write(row, i, force);
    return acting * rate;
}

/// 1 for the first lanes, 0 for the others.
[[nodiscard, gnu::always_inline]] inline PinLanes first_lanes(int count) noexcept {
    static constexpr std::array<PinReal, 2 * rigid_lanes> ones_and_zeros{1, 1, 1, 1, 1, 1, 1, 1};
    return load<pin_width>(ones_and_zeros.data() + (rigid_lanes - count));
}

/// 1 for pins first … first + 7, 0 for those that only fill the last vector.
[[nodiscard, gnu::always_inline]] inline PinLanes present(int pins, int first) noexcept {
    return first_lanes(std::min(rigid_lanes, pins - first));
}

/// Sum of eight numbers, in doubles.
[[nodiscard]] inline double total(const PinLanes& lanes) noexcept { return sum<rigid_lanes>(widened<pin_width>(lanes)); }

/// Sum over pins, without those that only fill the last vector.
class PinSum {
public:
    explicit PinSum(const PinColumns& columns) noexcept : pins_(columns.pins()) {}
    [[gnu::always_inline]] void add(int first, const PinLanes& terms) noexcept { add(present(pins_, first), terms); }
    [[gnu::always_inline]] void add(const PinLanes& present, const PinLanes& terms) noexcept { total_ += present * terms; }
    [[nodiscard]] double value() const noexcept { return total(total_); }

private:
    int pins_;
    PinLanes total_{0.0};
};

/// Sums over pins of the forces of their tips on the four sheaves, eight pins after the other.
class ReactionSum {
public:
    using Forces = std::array<PinLanes, 6>;
    ReactionSum() noexcept {
        for (auto& shaft : on_) shaft[0].fill(PinLanes(0.0)), shaft[1].fill(PinLanes(0.0));
    }
    /// @param second 1 for pins of the driven shaft   @param present 0 for pins that only fill the last vector
    /// @param forces of the tips on the pins at -z (0) or +z (1): the opposite of those on the sheaves
    [[gnu::always_inline]] void subtract(const PinLanes& second, const PinLanes& present, std::size_t side, const Forces& forces) noexcept {
        const PinLanes driven = present * second;
        subtract(present - driven, forces, on_[0][side]);
        subtract(driven, forces, on_[1][side]);
    }
    void store(SheaveForces& to) const noexcept {
        for (std::size_t sheave = 0; sheave < 4; ++sheave) {
            std::array<Lanes<rigid_lanes>, 6> wide;
            for (std::size_t k = 0; k < 6; ++k) wide[k] = widened<pin_width>(on_[sheave / 2][sheave % 2][k]);
            sums<rigid_lanes, 6>(wide, to[sheave].data());
        }
    }

private:
    [[gnu::always_inline]] static void subtract(const PinLanes& share, const Forces& forces, Forces& from) noexcept {
        if (all_at_most<pin_width>(share, 0.0)) return;
        for (std::size_t k = 0; k < 6; ++k) from[k] -= share * forces[k];
    }
    std::array<std::array<Forces, 2>, 2> on_;  ///< forces by shaft and side
};

/// Friction per free sliding velocity, so that F = -factor u.
/// @param capacity C = μ N, most friction [N]   @param response r of the sliding velocity to friction [m/s/N]
/// @param speed |u| of the velocity without friction [m/s]
template <int W>
[[nodiscard, gnu::always_inline]] inline Lanes<W> friction_factor(const FrictionCurve& curve, const Lanes<W>& capacity,
                                                                  const Lanes<W>& response, const Lanes<W>& speed) noexcept {
    const Lanes<W> braking = response * capacity;
    if (curve.law == FrictionLaw::piecewise) return capacity / larger<W>(speed, curve.saturation_speed + braking);
    return capacity / (divisor_left<W>(curve, speed - braking, braking) + braking);
}

}  // namespace

}  // namespace cvtflow::model
