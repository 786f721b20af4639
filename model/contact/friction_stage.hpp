#pragma once
/// Inputs and outputs of an evaluation of friction: a range of links with its velocities, and what is made of the accelerations.

#include <array>
#include <cstddef>

#include "model/basis/columns.hpp"
#include "model/parameters/chain_layout.hpp"

namespace cvtflow::model {

struct FrictionRange {
    int first, last;        ///< links [first, last)
    const float* velocity;  ///< [link_size()][stride] of links first - 1 … last
    std::ptrdiff_t stride;  ///< of velocity
    float* scratch;         ///< FrictionOperator::scratch_size(last - first) [m/s, N]
    const Phase* phases;    ///< [links * 4], of the whole chain
    double time;            ///< of the velocities, from the middle of the step, in steps [1]
    int shift = 1;          ///< column of a link in all fields but velocity: its number + shift
};

/// Accelerations by everything but friction, linear in time: now + extrapolation (now - before). Columns over links (column = link + 1).
struct FrictionBase {
    const FloatColumns* now;
    const FloatColumns* before;
    double extrapolation;  ///< share of the change since the last step [1]
};

/// Velocities that a table combines from others and from the slope just evaluated: Σ weight from + slope_weight slope, in this order.
struct VelocityRow {
    static constexpr std::size_t max_terms = 4;
    std::array<const FloatColumns*, max_terms> from{};
    std::array<double, max_terms> weight{};  ///< [1]
    std::size_t terms = 0;
    double slope_weight = 0.0;   ///< [s]
    FloatColumns* to = nullptr;  ///< none of `from`, nor the columns evaluated

    /// factor [1]
    void add(const FloatColumns& columns, double factor) noexcept {
        from[terms] = &columns;
        weight[terms++] = factor;
    }
};

/// Links at the end of a leapfrog's step, by the velocities that friction has left. Everything begins at the first link, and blocks [q | v]
/// of links follow one another.
struct StepEnd {
    const float* velocity;       ///< at the end: [link_size()][stride]
    std::ptrdiff_t stride;       ///< of velocity
    const double* counted_from;  ///< blocks; velocities count from theirs
    const double* start;         ///< blocks at the step's start
    double* end;                 ///< blocks at its end: coordinates by the mean of the velocities at both
    double* secants;             ///< blocks of slopes: velocities at the end, mean accelerations; nullptr: none
    double step;                 ///< [s]
    double limit;                ///< of every number of a sound state [m, m/s]
};

/// Purpose of an evaluation of friction: its slopes alone, or a row of a table. Columns over links (column = link + 1), all of the same
/// shape.
struct FrictionStage {
    const FrictionBase* base = nullptr;
    FloatColumns* slope = nullptr;            ///< may be absent from a row
    const VelocityRow* next = nullptr;        ///< with base, or neither
    double weight = 0.0;                      ///< of the tips' forces in their means [1]
    FloatColumns* mean_tip_forces = nullptr;  ///< [3 tips_per_link] rows: x, y, z of each tip
};

}  // namespace cvtflow::model
