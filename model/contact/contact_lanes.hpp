#pragma once
/// Contacts of links side by side: how they slide at the links' velocities, and how forces at them act on the links' coordinates.
/// (model/EQUATIONS.md sections 4 to 6) What the forces are is a matter of sweeps (sweep_lanes.hpp).
/// Velocities count from those at which contacts were recorded. Every lane does the same operations in the same order whatever its
/// neighbours are, so results do not depend on how links are grouped.

#include <algorithm>
#include <cstdint>
#include <utility>

#include "model/basis/lanes.hpp"
#include "model/contact/friction_operator.hpp"
#include "model/force/link_frame.hpp"
#include "model/machine/mirrored_matrix.hpp"

namespace cvtflow::model {
namespace {

/// Calls body<W>(first) for groups of W that cover [first, last): two vectors side by side as long as there is something for more than one;
/// the last group's lanes reach beyond the range.
template <class Body>
inline void over_groups(int first, int last, const Body& body) noexcept {
    constexpr int most = std::min(FloatColumns::line, 2 * native_floats), narrow = singles<native_floats>, wide = singles<most>;
    int group = first;
    for (; last - group > native_floats; group += most) body.template operator()<wide>(group);
    if (group < last) body.template operator()<narrow>(group);
}

/// Rows of columns: W lanes from one column on. @tparam Number float, or const float
template <int W, class Number>
struct LaneRows {
    Number* first;  ///< row 0, lane 0
    std::ptrdiff_t stride;

    [[nodiscard]] Lanes<W> operator[](int row) const noexcept { return load<W>(first + row * stride); }
    void put(int row, const Lanes<W>& lanes) const noexcept { lanes.copy_to(first + row * stride); }
};

/// W links side by side.
template <int W>
struct LinkLanes {
    using V = Lanes<W>;

    const ContactField& field;
    const FrictionRange& range;
    int group;  ///< the first of them, from the range's first link
    LaneRows<W, const float> contact = rows_of(field.columns);
    LaneRows<W, const float> velocity{range.velocity + group + 1, range.stride};

    /// The links before them.
    [[nodiscard]] LinkLanes before() const noexcept { return {field, range, group - 1}; }
    /// Number of lanes that represent links of the range.
    [[nodiscard]] int count() const noexcept { return std::min(lane_count<W>, range.last - range.first - group); }
    [[nodiscard]] int column() const noexcept { return range.first + group + range.shift; }
    [[nodiscard]] LaneRows<W, const float> rows_of(const FloatColumns& columns) const noexcept {
        return {columns.at(0, column()), columns.stride()};
    }
    [[nodiscard]] LaneRows<W, float> rows_of(FloatColumns& columns) const noexcept { return {columns.at(0, column()), columns.stride()}; }

    /// Angular velocity of the links.
    [[nodiscard]] V turning() const noexcept {
        const V vx = velocity[link_layout.x(End::front, 0)] - velocity[link_layout.x(End::rear, 0)];
        const V vy = velocity[link_layout.y(End::front, 0)] - velocity[link_layout.y(End::rear, 0)];
        return (contact[ContactComponents::frame_x] * vy - contact[ContactComponents::frame_y] * vx) *
               contact[ContactComponents::inverse_length];
    }
    /// Rates at which the gap between a link's pins opens: z, e.
    [[nodiscard]] std::pair<V, V> plate_rates() const noexcept {
        V z = velocity[link_layout.z(End::front)] - velocity[link_layout.z(End::rear)];
        V e = velocity[link_layout.e(End::front)] - velocity[link_layout.e(End::rear)];
        z += contact[field.components.plate_gap()];
        e += contact[field.components.plate_gap() + 1];
        return {z, e};
    }
    /// Whether a tip touches.
    [[nodiscard]] bool touch() const noexcept {
        const Phase* phases = range.phases + tips_per_link * (range.first + group);
        std::uint32_t any = 0;
        for (int link = 0; link < count(); ++link) any |= phase_word(phases + tips_per_link * link);
        return any != 0;
    }
    /// Adds a moment about z, as a couple of the links' ends.
    void add_couple(const V& moment, V* f) const noexcept {
        const V couple = moment * contact[ContactComponents::inverse_length];
        const V tx = contact[ContactComponents::frame_x], ty = contact[ContactComponents::frame_y];
        f[link_layout.x(End::front, 0)] = f[link_layout.x(End::front, 0)] - couple * ty;
        f[link_layout.y(End::front, 0)] += couple * tx;
        f[link_layout.x(End::rear, 0)] += couple * ty;
        f[link_layout.y(End::rear, 0)] = f[link_layout.y(End::rear, 0)] - couple * tx;
    }
};

/// Joints of the rear pins of links side by side.
template <int W>
struct JointContacts {
    using V = Lanes<W>;
    using Joint = ContactComponents::Joint;
    static constexpr int n = axis_terms;
    /// Rows of a joint's force: x_0…x_p, y_0…y_p, z, e, moments on the link before and on the link after it.
    static constexpr int z = 2 * n, e = z + 1, moment_before = e + 1, moment_after = moment_before + 1, rows = moment_after + 1;

    /// Relative velocities of both axes, and angular velocities of the links before and after the joint.
    struct Rates {
        V x[n], y[n], z, e, before, after;
    };

    const LinkLanes<W> links;
    const FrictionNumbers& numbers;

    [[nodiscard]] int points() const noexcept { return links.field.components.joint_points; }
    [[nodiscard]] float position(int g) const noexcept { return numbers.joint_points.position[static_cast<std::size_t>(g)]; }
    [[nodiscard]] float basis(int m, int g) const noexcept {
        return numbers.joint_points.basis[static_cast<std::size_t>(m)][static_cast<std::size_t>(g)];
    }
    /// A component of point g.
    [[nodiscard]] V contact(int g, int component) const noexcept { return links.contact[links.field.components.joint(g) + component]; }

    [[nodiscard, gnu::always_inline]] Rates rates() const noexcept {
        const LinkLanes<W> before = links.before();
        const int gap = links.field.components.joint_gap();
        Rates rates;
        for (int m = 0; m < n; ++m) {
            rates.x[m] = before.velocity[link_layout.x(End::front, m)] - links.velocity[link_layout.x(End::rear, m)];
            rates.y[m] = before.velocity[link_layout.y(End::front, m)] - links.velocity[link_layout.y(End::rear, m)];
        }
        rates.z = before.velocity[link_layout.z(End::front)] - links.velocity[link_layout.z(End::rear)];
        rates.e = before.velocity[link_layout.e(End::front)] - links.velocity[link_layout.e(End::rear)];
        rates.z += links.contact[gap];
        rates.e += links.contact[gap + 1];
        rates.before = before.turning();
        rates.after = links.turning();
        return rates;
    }
    /// Sliding of point g across the axis, where the axes move with x and y.
    [[nodiscard, gnu::always_inline]] V slip(int g, const V& x, const V& y, const Rates& rates) const noexcept {
        const V slip = contact(g, Joint::normal_x) * y - contact(g, Joint::normal_y) * x + rates.before * contact(g, Joint::lever_before) +
                       rates.after * contact(g, Joint::lever_after);
        return slip + links.contact[links.field.components.sliding(g)];
    }
};

/// Forces of a range's joints in its scratch, where the pass over links finds those of the pass over joints.
template <int W>
class JointForces {
public:
    using V = Lanes<W>;
    using Joints = JointContacts<W>;

    explicit JointForces(const FrictionRange& range) noexcept
        : scratch_(range.scratch), stride_(FrictionOperator::joint_stride(range.last - range.first)) {}

    /// @param joint the first of W   @param force rows
    void put(int joint, const V* force) const noexcept {
        for (int row = 0; row < Joints::rows; ++row) force[row].copy_to(scratch_ + row * stride_ + joint);
    }
    /// Sets the forces on links to those of the joints at their ends. @param link the first of W
    void act(int link, V* f) const noexcept {
        for (int m = 0; m < axis_terms; ++m) {
            f[link_layout.x(End::rear, m)] = -at(m, link);
            f[link_layout.y(End::rear, m)] = -at(axis_terms + m, link);
            f[link_layout.x(End::front, m)] = at(m, link + 1);
            f[link_layout.y(End::front, m)] = at(axis_terms + m, link + 1);
        }
        f[link_layout.z(End::rear)] = -at(Joints::z, link);
        f[link_layout.e(End::rear)] = -at(Joints::e, link);
        f[link_layout.z(End::front)] = at(Joints::z, link + 1);
        f[link_layout.e(End::front)] = at(Joints::e, link + 1);
    }
    /// Their moments on links. @param link the first of W
    [[nodiscard]] V moment(int link) const noexcept { return at(Joints::moment_after, link) + at(Joints::moment_before, link + 1); }

private:
    [[nodiscard]] V at(int row, int joint) const noexcept { return load<W>(scratch_ + row * stride_ + joint); }

    float* scratch_;
    std::ptrdiff_t stride_;
};

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

/// Tips of links side by side. The tips of an end are corners 2 end (ξ = -1) and 2 end + 1.
template <int W>
struct TipContacts {
    using V = Lanes<W>;
    using Tip = ContactComponents::Tip;

    const LinkLanes<W> links;

    /// A component of a tip.
    [[nodiscard]] V contact(int corner, int component) const noexcept {
        return links.contact[links.field.components.tip(corner) + component];
    }

    /// Velocities of the axis of an end at its tips.
    [[nodiscard]] AtTips<V> velocities(End end) const noexcept {
        V even[2], odd[2];  // modes of x and of y
        for (int axis = 0; axis < 2; ++axis) {
            const int row = axis == 0 ? link_layout.x(end, 0) : link_layout.y(end, 0);
            even[axis] = links.velocity[row];
            odd[axis] = V(0.0);
            for (int m = 1; m < axis_terms; ++m) (m % 2 == 0 ? even : odd)[axis] += links.velocity[row + m];
        }
        const V z = links.velocity[link_layout.z(end)], e = links.velocity[link_layout.e(end)];
        return {{even[0] - odd[0], even[1] - odd[1], z - e}, {even[0] + odd[0], even[1] + odd[1], z + e}};
    }
    /// Velocity along the sheave's surface. @param v of the axis' end   @param turn LinkLanes::turning()
    [[nodiscard]] AtTip<V> slip(int corner, AtTip<V> v, const V& turn) const noexcept {
        const V gx = contact(corner, Tip::normal), gy = contact(corner, Tip::normal + 1), gz = contact(corner, Tip::normal + 2);
        v.x = v.x - turn * contact(corner, Tip::lever_y);
        v.y = v.y + turn * contact(corner, Tip::lever_x);
        const auto time = static_cast<float>(links.range.time);
        v.x = v.x - contact(corner, Tip::sheave) - time * contact(corner, Tip::drift);
        v.y = v.y - contact(corner, Tip::sheave + 1) - time * contact(corner, Tip::drift + 1);
        v.z = v.z - contact(corner, Tip::sheave + 2) - time * contact(corner, Tip::drift + 2);
        const V along = v.x * gx + v.y * gy + v.z * gz;
        return {v.x - along * gx, v.y - along * gy, v.z - along * gz};
    }

    /// Adds forces on the tips of an end, and their moments about z.
    [[gnu::always_inline]] void act(End end, const AtTips<V>& forces, V* f, V& moment) const noexcept {
        const auto& [low, high] = forces;
        const V sum_x = low.x + high.x, sum_y = low.y + high.y, difference_x = high.x - low.x, difference_y = high.y - low.y;
        for (int m = 0; m < axis_terms; ++m) {
            f[link_layout.x(end, m)] += m % 2 == 0 ? sum_x : difference_x;
            f[link_layout.y(end, m)] += m % 2 == 0 ? sum_y : difference_y;
        }
        f[link_layout.z(end)] += low.z + high.z;
        f[link_layout.e(end)] += high.z - low.z;
        const int corner = 2 * static_cast<int>(end);
        add_moment(corner, low, moment);
        add_moment(corner + 1, high, moment);
    }

private:
    void add_moment(int corner, const AtTip<V>& force, V& moment) const noexcept {
        moment += contact(corner, Tip::lever_x) * force.y - contact(corner, Tip::lever_y) * force.x;
    }
};

}  // namespace
}  // namespace cvtflow::model
