#pragma once
/// The columns that friction reads and writes, W links at a time. Column numbers count from the first link of the range.

#include <algorithm>

#include "model/basis/single_lanes.hpp"
#include "model/contact/contact_field.hpp"
#include "model/force/link_frame.hpp"

namespace cvtflow::model {
namespace {

template <int P, int W>
class FrictionColumns {
protected:
    using V = Lanes<W>;
    using Number = NumberOf<W>;

    FrictionColumns(const ContactFieldOf<Number>& field, const FrictionRangeOf<Number>& range) noexcept
        : field_(field), range_(range), joint_stride_(FrictionOperator::joint_stride<Number>(range.last - range.first)) {}

    [[nodiscard]] int column(int own) const noexcept { return range_.first + own + range_.shift; }
    [[nodiscard]] V velocity(int row, int own) const noexcept { return load<W>(range_.velocity + row * range_.stride + own + 1); }
    [[nodiscard]] V contact(int row, int own) const noexcept { return load<W>(field_.columns.at(row, column(own))); }
    /// A row of the joints of the rear pins.
    [[nodiscard]] V joint(int row, int own) const noexcept { return load<W>(range_.scratch + row * joint_stride_ + own); }
    void keep_joint(int row, int own, const V& lanes) const noexcept { lanes.copy_to(range_.scratch + row * joint_stride_ + own); }

    /// How fast links turn.
    [[nodiscard]] V turning(int own) const noexcept {
        const V vx = velocity(at<P>.x(End::front, 0), own) - velocity(at<P>.x(End::rear, 0), own);
        const V vy = velocity(at<P>.y(End::front, 0), own) - velocity(at<P>.y(End::rear, 0), own);
        return (contact(ContactComponents::frame_x, own) * vy - contact(ContactComponents::frame_y, own) * vx) *
               contact(ContactComponents::inverse_length, own);
    }

    /// Lanes that stand for links of the range. In double precision all of them do: groups get narrower at the range's end.
    [[nodiscard]] int links_at(int own) const noexcept {
        if constexpr (is_single<W>) {
            return std::min(lane_count<W>, range_.last - range_.first - own);
        } else {
            return W;
        }
    }

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
    std::ptrdiff_t joint_stride_;
};

}  // namespace
}  // namespace cvtflow::model
