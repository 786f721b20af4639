#pragma once
/// The columns that friction reads and writes, W links at a time. Column numbers count from the first link of the range.

#include <algorithm>
#include <type_traits>

#include "model/basis/single_lanes.hpp"
#include "model/contact/contact_field.hpp"

namespace cvtflow::model {
namespace {

template <int W>
class FrictionColumns {
protected:
    using V = Lanes<W>;
    using Number = NumberOf<W>;

    FrictionColumns(const ContactFieldOf<Number>& field, const FrictionRangeOf<Number>& range) noexcept
        : field_(field), range_(range), scratch_stride_(FrictionOperator::joint_stride<Number>(range.last - range.first)) {}

    [[nodiscard]] int column(int own) const noexcept { return range_.first + own + range_.shift; }
    [[nodiscard]] V velocity(int row, int own) const noexcept { return load<W>(range_.velocity + row * range_.stride + own + 1); }
    [[nodiscard]] V contact(int row, int own) const noexcept { return load<W>(field_.columns.at(row, column(own))); }
    /// A row of scratch. @param place of the first lane, from 0 on
    [[nodiscard]] V kept(int row, int place) const noexcept { return load<W>(range_.scratch + row * scratch_stride_ + place); }
    void keep(int row, int place, const V& lanes) const noexcept { lanes.copy_to(range_.scratch + row * scratch_stride_ + place); }

    /// Lanes that represent links of the range.
    [[nodiscard]] int links_at(int own) const noexcept { return std::min(lane_count<W>, range_.last - range_.first - own); }

    /// Adds to a row of the range's links; columns beside them are others'.
    void add(int own, const V& lanes, ColumnsOf<Number>& columns, int row) const noexcept {
        Number* to = columns.at(row, column(own));
        if (links_at(own) == lane_count<W>) return (load<W>(to) + lanes).copy_to(to);
        Number sum[static_cast<std::size_t>(lane_count<W>)] = {};
        std::copy_n(to, links_at(own), sum);
        store_first<W>(load<W>(sum) + lanes, to, links_at(own));
    }

    const ContactFieldOf<Number>& field_;
    const FrictionRangeOf<Number>& range_;

private:
    std::ptrdiff_t scratch_stride_;
};

/// Calls body<W>(first) for groups of W that cover [first, last): two vectors side by side as long as there is something for more than one;
/// the last group's lanes reach beyond the range.
template <class Number, class Body>
inline void over_groups(int first, int last, const Body& body) noexcept {
    constexpr bool single = std::is_same_v<Number, float>;
    constexpr int native = single ? native_floats : native_lanes, most = std::min(ColumnsOf<Number>::line, 2 * native);
    constexpr int narrow = single ? singles<native> : native, wide = single ? singles<most> : most;
    int own = first;
    for (; last - own > native; own += most) body.template operator()<wide>(own);
    if (own < last) body.template operator()<narrow>(own);
}

}  // namespace
}  // namespace cvtflow::model
