#pragma once
/// From velocities to slips and from forces to accelerations, lanes over the links of a group. (model/EQUATIONS.md sections 4 to 6)

#include "model/contact/mirrored.hpp"
#include "model/contact/slip/slip_rows.hpp"
#include "model/force/link_frame.hpp"

namespace cvtflow::model {
namespace {

/// Points: of a joint, a constant for the compiler; 0: read from the space.
template <int P, int Points>
class SlipGeometry {
public:
    using Rows = SlipRows<Points>;
    using Point = typename Rows::Point;
    using Tip = typename Rows::Tip;
    using V = SlipV;
    static constexpr int n = P + 1;

    SlipGeometry(const SlipSpace& space, SlipGroup& group) noexcept
        : rows_(space, group), space_(space), c_(space.chain().coefficients()), g_(group) {}

    /// Each link's part of the slips of its contacts.
    void slips(double time, LaneRows& own) const noexcept {
        V velocity[at<P>.link_size()];
        for (int row = 0; row < at<P>.link_size(); ++row) velocity[row] = get(g_.velocity, row);
        each_slip(
            velocity, [&](int row, const V& slip) { put(own, row, slip); },
            [&](int corner, int k, const V& slip) {
                put(own, 2 * (SlipContacts::first_tip + corner) + k,
                    slip - rows_.tip_value(corner, Tip::sheave + k) - time * rows_.tip_value(corner, Tip::drift + k));
            });
    }

    /// -A⁻¹ Tᵀ λ.
    void accelerate() const noexcept {
        V acceleration[at<P>.link_size()];
        accelerations(g_.force, acceleration);
        for (int row = 0; row < at<P>.link_size(); ++row) put(g_.acceleration, row, acceleration[row]);
    }

    /// ŵ - g W λ, each link's part.
    void respond(const LaneRows& force, LaneRows& own) const noexcept {
        V acceleration[at<P>.link_size()];
        accelerations(force, acceleration);
        each_slip(
            acceleration, [&](int row, const V& change) { put(own, row, get(g_.predicted, row) + g_.step * change); },
            [&](int corner, int k, const V& change) {
                const int row = 2 * (SlipContacts::first_tip + corner) + k;
                put(own, row, get(g_.predicted, row) + g_.step * change);
            });
    }

private:
    [[nodiscard]] double basis(int m, int number) const noexcept {
        return c_.joint_points.basis[static_cast<std::size_t>(m)][static_cast<std::size_t>(number)];
    }
    [[nodiscard]] double position(int number) const noexcept { return c_.joint_points.position[static_cast<std::size_t>(number)]; }

    /// T v: calls put(row, slip) for plates and joints, put_tip(corner, k, slip) for tips; a tip where none touches has none.
    template <class Put, class PutTip>
    [[gnu::always_inline]] void each_slip(const V* v, const Put& put, const PutTip& put_tip) const noexcept {
        put(0, v[at<P>.z(End::front)] - v[at<P>.z(End::rear)]);
        put(1, v[at<P>.e(End::front)] - v[at<P>.e(End::rear)]);
        const V vx = v[at<P>.x(End::front, 0)] - v[at<P>.x(End::rear, 0)], vy = v[at<P>.y(End::front, 0)] - v[at<P>.y(End::rear, 0)];
        const V turn = get(g_.frame, 0) * vy - get(g_.frame, 1) * vx;  // |d0| θ'
        for (int corner = 0; corner < tips_per_link; ++corner) {
            if (g_.touching) {
                tip_slips(corner, v, turn, put_tip);
            } else {
                for (int k = 0; k < 2; ++k) put(2 * (SlipContacts::first_tip + corner) + k, V(0.0));
            }
        }
        for (const End end : {End::rear, End::front}) {
            for (int number = 0; number < rows_.points(); ++number) joint_slips(end, number, v, turn, put);
        }
    }

    template <class PutTip>
    [[gnu::always_inline]] void tip_slips(int corner, const V* v, const V& turn, const PutTip& put) const noexcept {
        const End end = corner < 2 ? End::rear : End::front;
        const double s = corner % 2 == 0 ? -1.0 : 1.0;
        V vx = v[at<P>.x(end, 0)], vy = v[at<P>.y(end, 0)];
        for (int m = 1; m < n; ++m) {
            const double value = m % 2 == 0 ? 1.0 : s;
            vx += value * v[at<P>.x(end, m)];
            vy += value * v[at<P>.y(end, m)];
        }
        const V vz = v[at<P>.z(end)] + s * v[at<P>.e(end)];
        for (int k = 0; k < 2; ++k) {
            const int tangent = Tip::tangent + 3 * k;
            put(corner, k,
                rows_.tip_value(corner, tangent) * vx + rows_.tip_value(corner, tangent + 1) * vy +
                    rows_.tip_value(corner, tangent + 2) * vz + rows_.tip_value(corner, Tip::lever + k) * turn);
        }
    }

    template <class Put>
    [[gnu::always_inline]] void joint_slips(End end, int number, const V* v, const V& turn, const Put& put) const noexcept {
        V vx = v[at<P>.x(end, 0)], vy = v[at<P>.y(end, 0)];
        for (int m = 1; m < n; ++m) {
            vx += basis(m, number) * v[at<P>.x(end, m)];
            vy += basis(m, number) * v[at<P>.y(end, m)];
        }
        const V across = rows_.point(end, number, Point::normal_x) * vy - rows_.point(end, number, Point::normal_y) * vx;
        const V axial = v[at<P>.z(end)] + position(number) * v[at<P>.e(end)];
        const V lever = rows_.point(end, number, Point::lever) * turn;
        const int row = 2 * rows_.contacts().joint(end, number);
        put(row, end == End::rear ? lever - across : lever + across);
        put(row + 1, end == End::rear ? -axial : axial);
    }

    /// -A⁻¹ Tᵀ λ.
    [[gnu::always_inline]] void accelerations(const LaneRows& force, V* acceleration) const noexcept {
        V f[at<P>.link_size()];
        for (V& row : f) row = V(0.0);
        V couple(0.0);
        const V z = get(force, 0), e = get(force, 1);
        f[at<P>.z(End::front)] = z;
        f[at<P>.e(End::front)] = e;
        f[at<P>.z(End::rear)] = -z;
        f[at<P>.e(End::rear)] = -e;
        if (g_.touching) {
            for (int corner = 0; corner < tips_per_link; ++corner) add_tip(force, corner, f, couple);
        }
        for (const End end : {End::rear, End::front}) {
            for (int number = 0; number < rows_.points(); ++number) add_joint(force, end, number, f, couple);
        }
        const V tx = get(g_.frame, 0), ty = get(g_.frame, 1);
        f[at<P>.x(End::front, 0)] = f[at<P>.x(End::front, 0)] - couple * ty;
        f[at<P>.y(End::front, 0)] += couple * tx;
        f[at<P>.x(End::rear, 0)] += couple * ty;
        f[at<P>.y(End::rear, 0)] = f[at<P>.y(End::rear, 0)] - couple * tx;
        accelerate_ends<n>(space_.friction().lateral_inverse(), f, acceleration);
        accelerate_ends<n>(space_.friction().lateral_inverse(), f + 2 * n, acceleration + 2 * n);
        accelerate_ends<2>(space_.friction().axial_inverse(), f + 4 * n, acceleration + 4 * n);
    }

    void add_tip(const LaneRows& force, int corner, V* f, V& couple) const noexcept {
        const End end = corner < 2 ? End::rear : End::front;
        const double s = corner % 2 == 0 ? -1.0 : 1.0;
        const V first = get(force, 2 * (SlipContacts::first_tip + corner)), second = get(force, 2 * (SlipContacts::first_tip + corner) + 1);
        const auto along = [&](int axis) {
            return rows_.tip_value(corner, Tip::tangent + axis) * first + rows_.tip_value(corner, Tip::tangent + 3 + axis) * second;
        };
        const V fx = along(0), fy = along(1), fz = along(2);
        for (int m = 0; m < n; ++m) {
            const double value = m % 2 == 0 ? 1.0 : s;
            f[at<P>.x(end, m)] += value * fx;
            f[at<P>.y(end, m)] += value * fy;
        }
        f[at<P>.z(end)] += fz;
        f[at<P>.e(end)] += s * fz;
        couple += rows_.tip_value(corner, Tip::lever) * first + rows_.tip_value(corner, Tip::lever + 1) * second;
    }

    void add_joint(const LaneRows& force, End end, int number, V* f, V& couple) const noexcept {
        const int row = 2 * rows_.contacts().joint(end, number);
        const V across = get(force, row), axial = get(force, row + 1);
        const V signed_across = end == End::rear ? -across : across, signed_axial = end == End::rear ? -axial : axial;
        const V fx = -(rows_.point(end, number, Point::normal_y) * signed_across),
                fy = rows_.point(end, number, Point::normal_x) * signed_across;
        f[at<P>.x(end, 0)] += fx;
        f[at<P>.y(end, 0)] += fy;
        for (int m = 1; m < n; ++m) {
            f[at<P>.x(end, m)] += basis(m, number) * fx;
            f[at<P>.y(end, m)] += basis(m, number) * fy;
        }
        f[at<P>.z(end)] += signed_axial;
        f[at<P>.e(end)] += position(number) * signed_axial;
        couple += rows_.point(end, number, Point::lever) * across;
    }

    template <int size>
    static void accelerate_ends(const MirroredInverse& inverse, const V* f, V* acceleration) noexcept {
        multiply_ends<size>(inverse, f, acceleration);
        for (int row = 0; row < 2 * size; ++row) acceleration[row] = -acceleration[row];
    }

    Rows rows_;
    const SlipSpace& space_;
    const Coefficients& c_;
    SlipGroup& g_;
};

}  // namespace
}  // namespace cvtflow::model
