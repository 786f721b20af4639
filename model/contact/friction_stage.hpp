#pragma once
/// Purposes of an evaluation of friction by tables of stages.

#include <array>
#include <cstddef>

#include "model/basis/columns.hpp"

namespace cvtflow::model {

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

/// Purpose of an evaluation of friction: its slopes alone, or a row of a table. Columns over links (column = link + 1), all of the same
/// shape.
struct FrictionStage {
    const FrictionBase* base = nullptr;
    FloatColumns* slope = nullptr;            ///< may be absent from a row
    const VelocityRow* next = nullptr;        ///< set together with `base`, or neither
    double weight = 0.0;                      ///< weight of the tips' forces in their means [1]
    FloatColumns* mean_tip_forces = nullptr;  ///< [3 tips_per_link] rows: x, y, z of each tip
};

}  // namespace cvtflow::model
