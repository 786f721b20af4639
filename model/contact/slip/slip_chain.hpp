#pragma once
/// Right-hand sides of the joints and their solution, from all groups. (model/contact/slip/slip_space.hpp)

#include <algorithm>
#include <array>

#include "model/contact/slip/joint_reduction.hpp"
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

namespace {

template <int Points>
class SlipElimination {
public:
    using F = FloatLanes;

    SlipElimination(const SlipContacts& contacts, std::span<const SlipGroup> groups, SlipChain& chain) noexcept
        : contacts_(contacts), size_(contacts.joint_slips()), groups_(groups), c_(chain) {}

    void solve() noexcept {
        for (int joint = 0; joint < c_.stretches.length(); ++joint) right_sides(joint);
        alignas(64) float starts[slip_lanes];  // 1 where a stretch begins at joint 1
        for (int lane = 0; lane < slip_lanes; ++lane) starts[lane] = groups_[0].present.at(0)[lane] == 0.0 ? 1.0f : 0.0f;
        for (std::size_t group = 0; group < groups_.size(); ++group) c_.elements[group] = &groups_[group].element;
        JointReduction<Points>(c_, c_.elements, load(starts)).solve();
    }

private:
    /// Rᵀ (ŵ - g W φ - w) of a group's rear joints.
    void right_sides(int joint) noexcept {
        const SlipGroup& g = groups_[static_cast<std::size_t>(joint)];
        for (int point = 0; point < size_ / 2; ++point) {
            F d[2];
            for (int k = 0; k < 2; ++k) {
                const int row = 2 * contacts_.joint(End::rear, point) + k;
                alignas(64) double before[slip_lanes];
                from_before(joint, row + size_, before);
                d[k] = narrow(get(g.part, row) + load<slip_lanes>(before) - get(g.slip, row));
            }
            const int root = 4 * contacts_.joint(End::rear, point);
            for (int i = 0; i < 2; ++i)
                put(c_.sides, joint * size_ + 2 * point + i, get(g.root, root + i) * d[0] + get(g.root, root + 2 + i) * d[1]);
        }
    }
    /// The front parts of the links before. to [slip_lanes]
    void from_before(int group, int row, double* to) const noexcept {
        if (group > 1) {
            std::copy_n(groups_[static_cast<std::size_t>(group - 1)].part.at(row), slip_lanes, to);
            return;
        }
        for (int lane = 0; lane < slip_lanes; ++lane) {
            const SlipStretches::Place before = c_.stretches.before({group, lane < c_.stretches.count() ? lane : 0});
            to[lane] = groups_[static_cast<std::size_t>(before.group)].part.at(row)[before.lane];
        }
    }

    SlipContacts contacts_;
    int size_;  ///< slips of a joint
    std::span<const SlipGroup> groups_;
    SlipChain& c_;
};

}  // namespace

}  // namespace cvtflow::model
