#pragma once
/// What becomes of an acceleration by friction: a slope, or a row of a table. All addresses are at hand: looking them up for every number
/// would take longer than the sums.

#include <algorithm>
#include <array>

#include "model/basis/single_lanes.hpp"
#include "model/contact/contact_field.hpp"

namespace cvtflow::model {
namespace {

/// @tparam W number of lanes, of which `lanes` represent links
template <int W>
struct SlopeSink {
    NumberOf<W>* slope;  ///< [m/s², rad/s²]
    std::ptrdiff_t stride;
    int lanes;

    void put(int row, const Lanes<W>& value) const noexcept { store_first<W>(value, slope + row * stride, lanes); }
};

/// @tparam Terms of the row; fewer are filled up with the last one, weight 0
template <int W, std::size_t Terms>
class RowSink {
public:
    using Number = NumberOf<W>;

    /// @param lanes that represent links
    RowSink(const FrictionStageOf<Number>& stage, const VelocityRowOf<Number>& next, int column, int lanes) noexcept
        : now_(stage.base->now->at(0, column)),
          before_(stage.base->before->at(0, column)),
          extrapolation_(static_cast<Number>(stage.base->extrapolation)),
          slope_weight_(static_cast<Number>(next.slope_weight)),
          slope_(stage.slope != nullptr ? stage.slope->at(0, column) : nullptr),
          to_(next.to->at(0, column)),
          stride_(next.to->stride()),
          lanes_(lanes) {
        for (std::size_t k = 0; k < Terms; ++k) {
            from_[k] = next.from[std::min(k, next.terms - 1)]->at(0, column);
            weight_[k] = static_cast<Number>(k < next.terms ? next.weight[k] : 0.0);
        }
    }

    [[gnu::always_inline]] void put(int row, Lanes<W> value) const noexcept {
        const std::ptrdiff_t at_row = row * stride_;
        const Lanes<W> base = load<W>(now_ + at_row);
        value += base + extrapolation_ * (base - load<W>(before_ + at_row));
        if (slope_ != nullptr) store_first<W>(value, slope_ + at_row, lanes_);
        Lanes<W> sum = weight_[0] * load<W>(from_[0] + at_row);
        for (std::size_t k = 1; k < Terms; ++k) sum += weight_[k] * load<W>(from_[k] + at_row);
        store_first<W>(sum + slope_weight_ * value, to_ + at_row, lanes_);
    }

private:
    const Number *now_, *before_;          ///< forces of the base [m/s², rad/s²]
    Number extrapolation_, slope_weight_;  ///< [1], [s]
    Number *slope_, *to_;                  ///< accelerations and velocities [m/s², m/s]
    std::ptrdiff_t stride_;
    int lanes_;
    std::array<const Number*, Terms> from_;
    std::array<Number, Terms> weight_;  ///< [1]
};

}  // namespace
}  // namespace cvtflow::model
