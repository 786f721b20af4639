#pragma once
/// Friction of the two tips of an axis as a function of velocities, lanes over links or pins: the columns that it reads, the force, and the
/// slope or table that it writes. (model/EQUATIONS.md section 6)
/// Every lane does the same operations in the same order whatever its neighbours are, so results do not depend on how they are grouped.

#include <algorithm>
#include <array>
#include <utility>

#include "model/basis/lanes.hpp"
#include "model/contact/friction_operator.hpp"
#include "model/force/tips.hpp"
#include "model/law/friction_laws.hpp"

namespace cvtflow::model {
namespace {

/// @tparam W number of lanes, of which `lanes` represent links
template <int W>
struct SlopeSink {
    float* slope;  ///< [m/s², rad/s²]
    std::ptrdiff_t stride;
    int lanes;

    void put(int row, const Lanes<W>& value) const noexcept { store_first<W>(value, slope + row * stride, lanes); }
};

/// @tparam Terms of the row; fewer are filled up with the last one, weight 0
template <int W, std::size_t Terms>
class RowSink {
public:
    /// @param lanes that represent links
    RowSink(const FrictionStage& stage, const VelocityRow& next, int column, int lanes) noexcept
        : now_(stage.base->now->at(0, column)),
          before_(stage.base->before->at(0, column)),
          extrapolation_(static_cast<float>(stage.base->extrapolation)),
          slope_weight_(static_cast<float>(next.slope_weight)),
          slope_(stage.slope != nullptr ? stage.slope->at(0, column) : nullptr),
          to_(next.to->at(0, column)),
          stride_(next.to->stride()),
          lanes_(lanes) {
        for (std::size_t k = 0; k < Terms; ++k) {
            from_[k] = next.from[std::min(k, next.terms - 1)]->at(0, column);
            weight_[k] = static_cast<float>(k < next.terms ? next.weight[k] : 0.0);
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
    const float *now_, *before_;          ///< forces of the base [m/s², rad/s²]
    float extrapolation_, slope_weight_;  ///< [1], [s]
    float *slope_, *to_;                  ///< accelerations and velocities [m/s², m/s]
    std::ptrdiff_t stride_;
    int lanes_;
    std::array<const float*, Terms> from_;
    std::array<float, Terms> weight_;  ///< [1]
};

template <int W>
class FrictionColumns {
protected:
    using V = Lanes<W>;

    FrictionColumns(const ContactField& field, const FrictionRange& range) noexcept
        : field_(field), range_(range), scratch_stride_(FrictionOperator::joint_stride(range.last - range.first)) {}

    [[nodiscard]] int column(int group) const noexcept { return range_.first + group + range_.shift; }
    [[nodiscard]] V velocity(int row, int group) const noexcept { return load<W>(range_.velocity + row * range_.stride + group + 1); }
    [[nodiscard]] V contact(int row, int group) const noexcept { return load<W>(field_.columns.at(row, column(group))); }
    /// A row of scratch. @param place of the first lane, from 0 on
    [[nodiscard]] V in_scratch(int row, int place) const noexcept { return load<W>(range_.scratch + row * scratch_stride_ + place); }
    void to_scratch(int row, int place, const V& lanes) const noexcept { lanes.copy_to(range_.scratch + row * scratch_stride_ + place); }

    /// Lanes that represent links of the range.
    [[nodiscard]] int links_at(int group) const noexcept { return std::min(lane_count<W>, range_.last - range_.first - group); }

    /// Adds to a row of the range's links; columns beside them are others'.
    void add(int group, const V& lanes, FloatColumns& columns, int row) const noexcept {
        float* to = columns.at(row, column(group));
        if (links_at(group) == lane_count<W>) return (load<W>(to) + lanes).copy_to(to);
        float sum[static_cast<std::size_t>(lane_count<W>)] = {};
        std::copy_n(to, links_at(group), sum);
        store_first<W>(load<W>(sum) + lanes, to, links_at(group));
    }

    const ContactField& field_;
    const FrictionRange& range_;

private:
    std::ptrdiff_t scratch_stride_;
};

/// Calls body<W>(first) for groups of W that cover [first, last): two vectors side by side as long as there is something for more than one;
/// the last group's lanes reach beyond the range.
template <class Body>
inline void over_groups(int first, int last, const Body& body) noexcept {
    constexpr int most = std::min(FloatColumns::line, 2 * native_floats), narrow = singles<native_floats>, wide = singles<most>;
    int group = first;
    for (; last - group > native_floats; group += most) body.template operator()<wide>(group);
    if (group < last) body.template operator()<narrow>(group);
}

/// Vector of one tip: velocity along its sheave's surface, or force.
template <class V>
struct AtTip {
    V x, y, z;
    [[nodiscard]] V square() const noexcept { return x * x + y * y + z * z; }
};

/// Vectors of the tips at ξ = -1 and at ξ = 1.
template <class V>
struct AtTips {
    AtTip<V> low, high;
};

/// Rows of an axis: x_0 and y_0, behind which the other modes are, and z, behind which e is.
struct AxisRows {
    int x, y, z;
};

/// W axes side by side; velocities count from those at which contacts were recorded.
template <int W, bool AllSticking>
class FrictionTips : protected FrictionColumns<W> {
    using Base = FrictionColumns<W>;

public:
    using V = Lanes<W>;

    FrictionTips(const FrictionOperator& friction, const ContactField& field, const FrictionRange& range) noexcept
        : Base(field, range), friction_(friction), numbers_(friction.numbers()) {}

protected:
    using Tip = ContactComponents::Tip;
    using Base::column, Base::velocity, Base::contact, Base::in_scratch, Base::to_scratch, Base::links_at, Base::add, Base::field_,
        Base::range_;
    static constexpr int n = axis_terms;

    /// Velocities of the axis in some rows at its tips.
    [[nodiscard]] AtTips<V> tip_velocities(int group, const AxisRows& rows) const noexcept {
        V even[2], odd[2];  // modes of x and of y
        for (int axis = 0; axis < 2; ++axis) {
            const int row = axis == 0 ? rows.x : rows.y;
            even[axis] = velocity(row, group);
            odd[axis] = V(0.0);
            for (int m = 1; m < n; ++m) (m % 2 == 0 ? even : odd)[axis] += velocity(row + m, group);
        }
        const V z = velocity(rows.z, group), e = velocity(rows.z + 1, group);
        return {{even[0] - odd[0], even[1] - odd[1], z - e}, {even[0] + odd[0], even[1] + odd[1], z + e}};
    }

    /// Forces at tips `low` and low + 1 of the axis in some rows; their moments about z are added. @param turn how fast the axis turns
    [[nodiscard]] AtTips<V> tip_friction(int group, int low, const AxisRows& rows, const V& turn, V& moment) const noexcept {
        const AtTips<V> velocities = tip_velocities(group, rows);
        const AtTip<V> a = slip(group, low, velocities.low, turn), b = slip(group, low + 1, velocities.high, turn);
        const auto [factor_a, factor_b] = factors(group, low, a.square(), b.square());
        const AtTip<V> below = force(group, low, a, factor_a, moment), above = force(group, low + 1, b, factor_b, moment);
        return {below, above};
    }

    /// Velocity along the sheave's surface. @param v of the axis' end
    [[nodiscard]] AtTip<V> slip(int group, int corner, AtTip<V> v, const V& turn) const noexcept {
        const int row = field_.components.tip(corner);
        const V gx = contact(row + Tip::normal, group), gy = contact(row + Tip::normal + 1, group),
                gz = contact(row + Tip::normal + 2, group);
        v.x = v.x - turn * contact(row + Tip::lever_y, group);
        v.y = v.y + turn * contact(row + Tip::lever_x, group);
        if constexpr (!AllSticking) {
            const auto time = static_cast<float>(range_.time);
            v.x = v.x - contact(row + Tip::sheave, group) - time * contact(row + Tip::drift, group);
            v.y = v.y - contact(row + Tip::sheave + 1, group) - time * contact(row + Tip::drift + 1, group);
            v.z = v.z - contact(row + Tip::sheave + 2, group) - time * contact(row + Tip::drift + 2, group);
        }
        const V along = v.x * gx + v.y * gy + v.z * gz;
        return {v.x - along * gx, v.y - along * gy, v.z - along * gz};
    }

    /// A sliding speed within the branch of the law of the tip's phase.
    [[nodiscard]] V within_branch(int group, int corner, const V& speed) const noexcept {
        const int row = field_.components.tip(corner);
        return larger<W>(smaller<W>(speed, contact(row + Tip::most, group)), contact(row + Tip::least, group));
    }

    /// Adds them to the axis' coordinates.
    static void spread(const AtTips<V>& tips, const AxisRows& rows, V* f) noexcept {
        const AtTip<V>&below = tips.low, &above = tips.high;
        const V sum_x = below.x + above.x, sum_y = below.y + above.y, difference_x = above.x - below.x, difference_y = above.y - below.y;
        for (int m = 0; m < n; ++m) {
            f[rows.x + m] += m % 2 == 0 ? sum_x : difference_x;
            f[rows.y + m] += m % 2 == 0 ? sum_y : difference_y;
        }
        f[rows.z] += below.z + above.z;
        f[rows.z + 1] += above.z - below.z;
    }

    /// Adds them to the mean forces of tips `low` and low + 1, if those are requested.
    void add_mean_tip_forces(int group, int low, const AtTips<V>& tips, const FrictionStage& stage) const noexcept {
        if (stage.mean_tip_forces == nullptr) return;
        const auto weight = static_cast<float>(stage.weight);
        int row = 3 * low;
        for (const AtTip<V>* tip : {&tips.low, &tips.high}) {
            add(group, weight * tip->x, *stage.mean_tip_forces, row++);
            add(group, weight * tip->y, *stage.mean_tip_forces, row++);
            add(group, weight * tip->z, *stage.mean_tip_forces, row++);
        }
    }

    /// Calls give(sink) with where accelerations of a group go.
    template <class Give>
    void with_sink(int group, const FrictionStage& stage, const Give& give) const noexcept {
        if (stage.next == nullptr) return give(SlopeSink<W>{stage.slope->at(0, column(group)), stage.slope->stride(), links_at(group)});
        if (stage.next->terms <= 2) return give(RowSink<W, 2>(stage, *stage.next, column(group), links_at(group)));
        give(RowSink<W, VelocityRow::max_terms>(stage, *stage.next, column(group), links_at(group)));
    }

    const FrictionOperator& friction_;
    const FrictionNumbers& numbers_;

private:
    [[nodiscard]] AtTip<V> force(int group, int corner, const AtTip<V>& slip, const V& factor, V& moment) const noexcept {
        const int row = field_.components.tip(corner);
        const V friction_per_speed = -contact(row + Tip::friction_limit, group) * factor;
        const AtTip<V> force{friction_per_speed * slip.x, friction_per_speed * slip.y, friction_per_speed * slip.z};
        moment += contact(row + Tip::lever_x, group) * force.y - contact(row + Tip::lever_y, group) * force.x;
        return force;
    }

    /// Factors of tips `low` and low + 1, whose slips have these squares.
    [[nodiscard]] std::pair<V, V> factors(int group, int low, const V& first, const V& second) const noexcept {
        if (AllSticking || numbers_.tip_law == nullptr) return plain_factors(group, low, first, second);
        const auto [a, b] = plain_factors(group, low, first, second);
        const TipLaw& law = *numbers_.tip_law;
        return {a * speed_factor_of_square<W>(law, first), b * speed_factor_of_square<W>(law, second)};
    }

    /// Without the law by speed of the tips, which makes them no larger.
    [[nodiscard]] std::pair<V, V> plain_factors(int group, int low, const V& first, const V& second) const noexcept {
        if (AllSticking || !friction_.by_phase()) return sliding_factors<W, AllSticking>(numbers_.tip, first, second);
        return {1.0 / within_branch(group, low, sqrt(first)), 1.0 / within_branch(group, low + 1, sqrt(second))};
    }
};

}  // namespace
}  // namespace cvtflow::model
