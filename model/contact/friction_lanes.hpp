#pragma once
/// Friction of all contacts as a function of velocities, lanes over links. (model/EQUATIONS.md sections 4 to 7)
/// Every lane does the same operations in the same order whatever its neighbours are, so results do not depend on how links are grouped.

#include "model/basis/lanes.hpp"
#include "model/contact/friction_operator.hpp"
#include "model/contact/friction_tips.hpp"
#include "model/force/link_frame.hpp"

namespace cvtflow::model {
namespace {

/// W links side by side; velocities count from those at which contacts were recorded, column numbers from the first link of the range.
template <int W, bool AllSticking>
class FrictionLanes : protected FrictionTips<W, AllSticking> {
    using Base = FrictionTips<W, AllSticking>;

protected:
    using Base::velocity, Base::contact, Base::in_scratch, Base::to_scratch, Base::links_at, Base::field_, Base::range_, Base::numbers_;

public:
    using V = Lanes<W>;
    using Joint = ContactComponents::Joint;
    static constexpr int n = axis_terms;
    /// Rows of a joint's force: x_0…x_p, y_0…y_p, z, e, moment before, moment after.
    static constexpr int joint_rows = 2 * n + 4;

    using Base::Base;

    /// Joint of the rear pins of links first + group … + W - 1, to scratch.
    void joints(int group) const noexcept {
        const JointRates rates = joint_rates(group);
        V force[joint_rows];
        for (V& row : force) row = V(0.0);
        const int points = field_.components.joint_points;
        for (int g = 0; g < points / 2; ++g) mirrored_points(group, g, rates, force);
        if (points % 2 == 1) middle_point(group, points / 2, rates, force);
        for (int row = 0; row < joint_rows; ++row) to_scratch(row, group, force[row]);
    }

    /// Slopes of links first + group … + W - 1; their joints must be in scratch.
    void links(int group, const FrictionStage& stage) const noexcept {
        V f[link_layout.link_size()];
        add_joints(group, f);
        V moment = in_scratch(2 * n + 3, group) + in_scratch(2 * n + 2, group + 1);
        plates(group, f);
        if (touching(group)) tips(group, f, moment, stage);
        add_couple(group, moment, f);
        Base::with_sink(group, stage, [&](const auto& sink) { accelerate(f, sink); });
    }

protected:
    /// Relative velocities in a joint: of the axes, and how fast the links before and after it turn.
    struct JointRates {
        V x[n], y[n], z, e, before, after;
    };

    [[nodiscard]] JointRates joint_rates(int group) const noexcept {
        JointRates rates;
        for (int m = 0; m < n; ++m) {
            rates.x[m] = velocity(link_layout.x(End::front, m), group - 1) - velocity(link_layout.x(End::rear, m), group);
            rates.y[m] = velocity(link_layout.y(End::front, m), group - 1) - velocity(link_layout.y(End::rear, m), group);
        }
        rates.z = velocity(link_layout.z(End::front), group - 1) - velocity(link_layout.z(End::rear), group);
        rates.e = velocity(link_layout.e(End::front), group - 1) - velocity(link_layout.e(End::rear), group);
        if constexpr (!AllSticking) {
            rates.z += contact(field_.components.joint_gap(), group);
            rates.e += contact(field_.components.joint_gap() + 1, group);
        }
        rates.before = turning(group - 1);
        rates.after = turning(group);
        return rates;
    }

    /// How fast the gap between a link's pins opens: z, e.
    [[nodiscard]] std::pair<V, V> plate_rates(int group) const noexcept {
        V z = velocity(link_layout.z(End::front), group) - velocity(link_layout.z(End::rear), group);
        V e = velocity(link_layout.e(End::front), group) - velocity(link_layout.e(End::rear), group);
        if constexpr (!AllSticking) {
            z += contact(field_.components.plate_gap(), group);
            e += contact(field_.components.plate_gap() + 1, group);
        }
        return {z, e};
    }
    /// Legendre modes of even and of odd order summed apart, so that they serve the points at ξ and at -ξ.
    struct Halves {
        V even, odd;
    };
    struct PointForce {
        V x, y, along;
    };

    [[nodiscard]] Halves halves_at(const V* modes, int g) const noexcept {
        Halves sum{modes[0], V(0.0)};
        if constexpr (n > 1) sum.odd = basis(1, g) * modes[1];
        if constexpr (n > 2) sum.even += basis(2, g) * modes[2];
        if constexpr (n > 3) sum.odd += basis(3, g) * modes[3];
        return sum;
    }

    /// Sliding of point g across the axis.
    [[nodiscard, gnu::always_inline]] V slip_of(int group, int g, const V& x, const V& y, const JointRates& rates) const noexcept {
        const int row = field_.components.joint(g);
        const V slip = contact(row + Joint::normal_x, group) * y - contact(row + Joint::normal_y, group) * x +
                       rates.before * contact(row + Joint::lever_before, group) + rates.after * contact(row + Joint::lever_after, group);
        if constexpr (!AllSticking) return slip + contact(field_.components.sliding(g), group);
        return slip;
    }

    /// Force at point g that slides with slip and axial; moments to force.
    [[nodiscard]] PointForce point_force(int group, int g, const V& slip, const V& axial, const V& factor, V* force) const noexcept {
        const int row = field_.components.joint(g);
        const V friction_per_speed = contact(row + Joint::friction_limit, group) * factor;
        const V across = friction_per_speed * slip;  // against the motion: signs below
        force[2 * n + 2] = force[2 * n + 2] - across * contact(row + Joint::lever_before, group);
        force[2 * n + 3] = force[2 * n + 3] - across * contact(row + Joint::lever_after, group);
        return {across * contact(row + Joint::normal_y, group), -(across * contact(row + Joint::normal_x, group)),
                -(friction_per_speed * axial)};
    }

    /// Points g and count - 1 - g, at ξ and -ξ.
    void mirrored_points(int group, int g, const JointRates& rates, V* force) const noexcept {
        const int h = field_.components.joint_points - 1 - g;
        const float xi = numbers_.joint_position[static_cast<std::size_t>(g)];
        const Halves x = halves_at(rates.x, g), y = halves_at(rates.y, g);
        const V slip_g = slip_of(group, g, x.even + x.odd, y.even + y.odd, rates),
                slip_h = slip_of(group, h, x.even - x.odd, y.even - y.odd, rates);
        const V tilt = xi * rates.e;
        const V axial_g = rates.z + tilt, axial_h = rates.z - tilt;
        const auto [factor_g, factor_h] =
            sliding_factors<W, AllSticking>(numbers_.joint, slip_g * slip_g + axial_g * axial_g, slip_h * slip_h + axial_h * axial_h);
        const PointForce a = point_force(group, g, slip_g, axial_g, factor_g, force),
                         b = point_force(group, h, slip_h, axial_h, factor_h, force);
        spread(g, a.x + b.x, a.x - b.x, force);
        spread(g, a.y + b.y, a.y - b.y, force + n);
        force[2 * n] += a.along + b.along;
        force[2 * n + 1] += xi * (a.along - b.along);
    }

    /// The point at ξ = 0.
    void middle_point(int group, int g, const JointRates& rates, V* force) const noexcept {
        const V slip = slip_of(group, g, halves_at(rates.x, g).even, halves_at(rates.y, g).even, rates);
        const PointForce f =
            point_force(group, g, slip, rates.z, sliding_factor<W, AllSticking>(numbers_.joint, slip * slip + rates.z * rates.z), force);
        spread(g, f.x, V(0.0), force);
        spread(g, f.y, V(0.0), force + n);
        force[2 * n] += f.along;
    }

    /// Adds the forces at two mirrored points, as sum and difference, to the modes.
    void spread(int g, const V& sum, const V& difference, V* modes) const noexcept {
        modes[0] += sum;
        if constexpr (n > 1) modes[1] += basis(1, g) * difference;
        if constexpr (n > 2) modes[2] += basis(2, g) * sum;
        if constexpr (n > 3) modes[3] += basis(3, g) * difference;
    }

    [[nodiscard]] float basis(int m, int point) const noexcept {
        return numbers_.joint_basis[static_cast<std::size_t>(m)][static_cast<std::size_t>(point)];
    }

    void add_joints(int group, V* f) const noexcept {
        for (int m = 0; m < n; ++m) {
            f[link_layout.x(End::rear, m)] = -in_scratch(m, group);
            f[link_layout.y(End::rear, m)] = -in_scratch(n + m, group);
            f[link_layout.x(End::front, m)] = in_scratch(m, group + 1);
            f[link_layout.y(End::front, m)] = in_scratch(n + m, group + 1);
        }
        f[link_layout.z(End::rear)] = -in_scratch(2 * n, group);
        f[link_layout.e(End::rear)] = -in_scratch(2 * n + 1, group);
        f[link_layout.z(End::front)] = in_scratch(2 * n, group + 1);
        f[link_layout.e(End::front)] = in_scratch(2 * n + 1, group + 1);
    }

    /// Adds the couple of the links' ends that a moment about z is.
    void add_couple(int group, const V& moment, V* f) const noexcept {
        const V couple = moment * contact(ContactComponents::inverse_length, group);
        const V tx = contact(ContactComponents::frame_x, group), ty = contact(ContactComponents::frame_y, group);
        f[link_layout.x(End::front, 0)] = f[link_layout.x(End::front, 0)] - couple * ty;
        f[link_layout.y(End::front, 0)] += couple * tx;
        f[link_layout.x(End::rear, 0)] += couple * ty;
        f[link_layout.y(End::rear, 0)] = f[link_layout.y(End::rear, 0)] - couple * tx;
    }

    void plates(int group, V* f) const noexcept {
        const auto [gap_z, gap_e] = plate_rates(group);
        V fz(0.0), fe(0.0);
        for (int j = 0; j < field_.components.plates; ++j) {
            const float xi = numbers_.plate_position[static_cast<std::size_t>(j)];
            const V sliding = gap_z + xi * gap_e;
            const V slide = contact(field_.components.plate(j), group) * sliding_share<W, AllSticking>(numbers_.plate, sliding);
            fz += slide;
            fe += xi * slide;
        }
        f[link_layout.z(End::front)] = f[link_layout.z(End::front)] - fz;
        f[link_layout.e(End::front)] = f[link_layout.e(End::front)] - fe;
        f[link_layout.z(End::rear)] += fz;
        f[link_layout.e(End::rear)] += fe;
    }

    /// Whether a tip of the links side by side touches.
    [[nodiscard]] bool touching(int group) const noexcept {
        const Phase* phases = range_.phases + tips_per_link * (range_.first + group);
        std::uint32_t any = 0;
        for (int link = 0; link < links_at(group); ++link) any |= phase_word(phases + tips_per_link * link);
        return any != 0;
    }

    void tips(int group, V* f, V& moment, const FrictionStage& stage) const noexcept {
        const V turn = turning(group);
        for (const End end : {End::rear, End::front}) {
            const AxisRows rows{link_layout.x(end, 0), link_layout.y(end, 0), link_layout.z(end)};
            const int low = 2 * static_cast<int>(end);
            const AtTips<V> forces = Base::tip_friction(group, low, rows, turn, moment);
            Base::add_mean_tip_forces(group, low, forces, stage);
            Base::spread(forces, rows, f);
        }
    }

    /// How fast links turn.
    [[nodiscard]] V turning(int group) const noexcept {
        const V vx = velocity(link_layout.x(End::front, 0), group) - velocity(link_layout.x(End::rear, 0), group);
        const V vy = velocity(link_layout.y(End::front, 0), group) - velocity(link_layout.y(End::rear, 0), group);
        return (contact(ContactComponents::frame_x, group) * vy - contact(ContactComponents::frame_y, group) * vx) *
               contact(ContactComponents::inverse_length, group);
    }

    /// A⁻¹ f of links that are not held.
    template <class Sink>
    void accelerate(const V* f, const Sink& to) const noexcept {
        for (int axis = 0; axis < 2; ++axis) accelerate_ends<n>(numbers_.across, f + 2 * n * axis, 2 * n * axis, to);
        accelerate_ends<2>(numbers_.axial, f + 4 * n, 4 * n, to);
    }

    /// Rows row … row + 2 size - 1: `size` modes of the rear pin, then of the front pin.
    template <int size, class Sink>
    static void accelerate_ends(const MirroredMatrix<float>& inverse, const V* force, int row, const Sink& to) noexcept {
        V product[2 * size];
        multiply_ends<size>(inverse, force, product);
        for (int k = 0; k < 2 * size; ++k) to.put(row + k, product[k]);
    }
};

/// Slopes of the links of a range: their joints, then the links.
template <bool AllSticking>
inline void evaluate_links(const FrictionOperator& friction, const ContactField& field, const FrictionRange& range,
                           const FrictionStage& stage) noexcept {
    const int links = range.last - range.first;
    over_groups(0, links + 1, [&]<int W>(int group) { FrictionLanes<W, AllSticking>(friction, field, range).joints(group); });
    over_groups(0, links, [&]<int W>(int group) { FrictionLanes<W, AllSticking>(friction, field, range).links(group, stage); });
}

}  // namespace
}  // namespace cvtflow::model
