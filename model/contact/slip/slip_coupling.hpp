#pragma once
/// g W = g T A⁻¹ Tᵀ of a link's contacts. All of them act along few constant directions, so products with A⁻¹ are known beforehand.

#include <array>

#include "model/contact/slip/slip_rows.hpp"

namespace cvtflow::model {
namespace {

template <int Points>
class SlipCoupling {
public:
    using Rows = SlipRows<Points>;
    using Point = typename Rows::Point;
    using Tip = typename Rows::Tip;
    using V = SlipV;
    using F = FloatLanes;

    SlipCoupling(const SlipSpace& space, SlipGroup& group) noexcept : contacts_(space, group), space_(space), g_(group) {}

    /// g [s]
    void couple(double g) noexcept {
        g_.step = g;
        list();
        for (int row = 0; row < count_; ++row) {
            const Row a = rows_[static_cast<std::size_t>(row)].scaled(static_cast<float>(g));
            for (int column = 0; column <= row; ++column) {
                const Row& b = rows_[static_cast<std::size_t>(column)];
                const bool lateral = a.lateral >= 0 && b.lateral >= 0, axial = a.axial >= 0 && b.axial >= 0;
                if (!lateral && !axial) continue;  // zero from the beginning
                F value(0.0f);
                if (lateral)
                    value = static_cast<float>(space_.lateral(a.lateral, b.lateral)) * (a.ax * b.ax + a.ay * b.ay) +
                            (a.turning * b.lever + a.lever * b.turned);
                if (axial) value = value + static_cast<float>(space_.axial(a.axial, b.axial)) * (a.along * b.along);
                put(g_.coupling, triangle(a.number, b.number), value);
            }
        }
    }

private:
    /// One slip as a combination of directions: (ax, ay) on `lateral`, lever on the turning, along on `axial`; < 0: none.
    struct Row {
        int number = 0, lateral = -1, axial = -1;
        F ax, ay, lever, along;
        F turned, turning;  ///< what the turning has of (ax, ay); the same with the lever's own part

        [[nodiscard]] Row scaled(float g) const noexcept {
            return {number, lateral, axial, g * ax, g * ay, g * lever, g * along, turned, g * turning};
        }
    };
    static constexpr std::size_t most = static_cast<std::size_t>(SlipContacts{Points > 0 ? Points : max_joint_lanes}.slips());

    Row& add(int number) noexcept {
        Row& row = rows_[static_cast<std::size_t>(count_++)];
        row = Row{};
        row.number = number;
        row.along = 1.0f;
        return row;
    }

    void act(Row& row, int direction, const V& ax, const V& ay, const V& lever) const noexcept {
        row.lateral = direction;
        row.ax = narrow(ax);
        row.ay = narrow(ay);
        row.lever = narrow(lever);
        const int turn = space_.turning();
        row.turned = narrow(space_.lateral(direction, turn) * (get(g_.frame, 0) * ay - get(g_.frame, 1) * ax));
        row.turning = row.turned + static_cast<float>(space_.lateral(turn, turn)) * row.lever;
    }

    void list() noexcept {
        const int points = contacts_.points();
        const SlipContacts contacts = contacts_.contacts();
        count_ = 0;
        add(0).axial = 4 + 2 * points;
        add(1).axial = 5 + 2 * points;
        for (int corner = 0; corner < (g_.touching ? tips_per_link : 0); ++corner) {
            for (int k = 0; k < 2; ++k) {
                const auto tangent = [&](int axis) { return contacts_.tip_value(corner, Tip::tangent + 3 * k + axis); };
                Row& row = add(2 * (SlipContacts::first_tip + corner) + k);
                act(row, corner, tangent(0), tangent(1), contacts_.tip_value(corner, Tip::lever + k));
                row.axial = corner;
                row.along = narrow(tangent(2));
            }
        }
        for (const End end : {End::rear, End::front}) {
            const double sign = end == End::rear ? -1.0 : 1.0;
            for (int number = 0; number < points; ++number) {
                const int slip = 2 * contacts.joint(end, number), direction = 4 + (end == End::rear ? 0 : points) + number;
                act(add(slip), direction, -sign * contacts_.point(end, number, Point::normal_y),
                    sign * contacts_.point(end, number, Point::normal_x), contacts_.point(end, number, Point::lever));
                add(slip + 1).axial = direction;
            }
        }
    }

    Rows contacts_;
    const SlipSpace& space_;
    SlipGroup& g_;
    std::array<Row, most> rows_;
    int count_ = 0;
};

}  // namespace
}  // namespace cvtflow::model
