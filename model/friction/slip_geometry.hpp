#pragma once
/// From velocities to slips and from forces to accelerations, lanes over the links of a group. (model/EQUATIONS.md sections 4 to 6)

#include "model/force/link_frame.hpp"
#include "model/friction/mirrored.hpp"
#include "model/friction/slip_rows.hpp"

namespace cvtflow::model {
namespace {

/// Points: of a joint, a constant for the compiler; 0: read from the space.
template <int P, int Points>
class SlipGeometry : public SlipRows<Points> {
public:
    using Base = SlipRows<Points>;
    using typename Base::Point;
    using typename Base::Tip;
    using V = SlipV;
    static constexpr int n = P + 1;
    using Base::Base;

    /// Each link's part of the slips of its contacts.
    void slips(double time, LaneRows& own) const noexcept {
        const V turn = turning();
        const V gap_z = v(at<P>.z(End::front)) - v(at<P>.z(End::rear)), gap_e = v(at<P>.e(End::front)) - v(at<P>.e(End::rear));
        put(own, 0, gap_z);
        put(own, 1, gap_e);
        for (int corner = 0; corner < tips_per_link; ++corner) {
            const int row = 2 * (SlipContacts::first_tip + corner);
            if (g_.touching) {
                tip_slips(corner, turn, time, own);
            } else {
                put(own, row, V(0.0));
                put(own, row + 1, V(0.0));
            }
        }
        for (const End end : {End::rear, End::front}) {
            for (int number = 0; number < points(); ++number) joint_slips(end, number, turn, own);
        }
    }

    /// -A⁻¹ Tᵀ λ.
    void accelerate() noexcept {
        V f[at<P>.link_size()];
        for (V& row : f) row = V(0.0);
        V couple(0.0);
        const V z = get(g_.force, 0), e = get(g_.force, 1);
        f[at<P>.z(End::front)] = z;
        f[at<P>.e(End::front)] = e;
        f[at<P>.z(End::rear)] = -z;
        f[at<P>.e(End::rear)] = -e;
        if (g_.touching) {
            for (int corner = 0; corner < tips_per_link; ++corner) add_tip(corner, f, couple);
        }
        for (const End end : {End::rear, End::front}) {
            for (int number = 0; number < points(); ++number) add_joint(end, number, f, couple);
        }
        const V tx = get(g_.frame, 0), ty = get(g_.frame, 1);
        f[at<P>.x(End::front, 0)] = f[at<P>.x(End::front, 0)] - couple * ty;
        f[at<P>.y(End::front, 0)] += couple * tx;
        f[at<P>.x(End::rear, 0)] += couple * ty;
        f[at<P>.y(End::rear, 0)] = f[at<P>.y(End::rear, 0)] - couple * tx;
        accelerate_ends<n>(space_.friction().lateral_inverse(), f, 0);
        accelerate_ends<n>(space_.friction().lateral_inverse(), f, 2 * n);
        accelerate_ends<2>(space_.friction().axial_inverse(), f, 4 * n);
    }

private:
    using Base::c_;
    using Base::contacts;
    using Base::g_;
    using Base::point;
    using Base::points;
    using Base::space_;
    using Base::tip_value;

    [[nodiscard]] V v(int row) const noexcept { return get(g_.velocity, row); }
    [[nodiscard]] double basis(int m, int number) const noexcept { return c_.joint_points.basis[static_cast<std::size_t>(m)][static_cast<std::size_t>(number)]; }
    [[nodiscard]] double position(int number) const noexcept { return c_.joint_points.position[static_cast<std::size_t>(number)]; }

    /// |d0| θ'
    [[nodiscard]] V turning() const noexcept {
        const V vx = v(at<P>.x(End::front, 0)) - v(at<P>.x(End::rear, 0)), vy = v(at<P>.y(End::front, 0)) - v(at<P>.y(End::rear, 0));
        return get(g_.frame, 0) * vy - get(g_.frame, 1) * vx;
    }

    void tip_slips(int corner, const V& turn, double time, LaneRows& own) const noexcept {
        const End end = corner < 2 ? End::rear : End::front;
        const double s = corner % 2 == 0 ? -1.0 : 1.0;
        V vx = v(at<P>.x(end, 0)), vy = v(at<P>.y(end, 0));
        for (int m = 1; m < n; ++m) {
            const double value = m % 2 == 0 ? 1.0 : s;
            vx += value * v(at<P>.x(end, m));
            vy += value * v(at<P>.y(end, m));
        }
        const V vz = v(at<P>.z(end)) + s * v(at<P>.e(end));
        for (int k = 0; k < 2; ++k) {
            const int tangent = Tip::tangent + 3 * k;
            const V slip = tip_value(corner, tangent) * vx + tip_value(corner, tangent + 1) * vy + tip_value(corner, tangent + 2) * vz +
                           tip_value(corner, Tip::lever + k) * turn;
            put(own, 2 * (SlipContacts::first_tip + corner) + k, slip - tip_value(corner, Tip::sheave + k) - time * tip_value(corner, Tip::drift + k));
        }
    }

    void joint_slips(End end, int number, const V& turn, LaneRows& own) const noexcept {
        V vx = v(at<P>.x(end, 0)), vy = v(at<P>.y(end, 0));
        for (int m = 1; m < n; ++m) {
            vx += basis(m, number) * v(at<P>.x(end, m));
            vy += basis(m, number) * v(at<P>.y(end, m));
        }
        const V across = point(end, number, Point::normal_x) * vy - point(end, number, Point::normal_y) * vx;
        const V axial = v(at<P>.z(end)) + position(number) * v(at<P>.e(end));
        const V lever = point(end, number, Point::lever) * turn;
        const int row = 2 * contacts().joint(end, number);
        put(own, row, end == End::rear ? lever - across : lever + across);
        put(own, row + 1, end == End::rear ? -axial : axial);
    }

    void add_tip(int corner, V* f, V& couple) const noexcept {
        const End end = corner < 2 ? End::rear : End::front;
        const double s = corner % 2 == 0 ? -1.0 : 1.0;
        const V first = get(g_.force, 2 * (SlipContacts::first_tip + corner)), second = get(g_.force, 2 * (SlipContacts::first_tip + corner) + 1);
        const auto along = [&](int axis) { return tip_value(corner, Tip::tangent + axis) * first + tip_value(corner, Tip::tangent + 3 + axis) * second; };
        const V fx = along(0), fy = along(1), fz = along(2);
        for (int m = 0; m < n; ++m) {
            const double value = m % 2 == 0 ? 1.0 : s;
            f[at<P>.x(end, m)] += value * fx;
            f[at<P>.y(end, m)] += value * fy;
        }
        f[at<P>.z(end)] += fz;
        f[at<P>.e(end)] += s * fz;
        couple += tip_value(corner, Tip::lever) * first + tip_value(corner, Tip::lever + 1) * second;
    }

    void add_joint(End end, int number, V* f, V& couple) const noexcept {
        const int row = 2 * contacts().joint(end, number);
        const V across = get(g_.force, row), axial = get(g_.force, row + 1);
        const V signed_across = end == End::rear ? -across : across, signed_axial = end == End::rear ? -axial : axial;
        const V fx = -(point(end, number, Point::normal_y) * signed_across), fy = point(end, number, Point::normal_x) * signed_across;
        f[at<P>.x(end, 0)] += fx;
        f[at<P>.y(end, 0)] += fy;
        for (int m = 1; m < n; ++m) {
            f[at<P>.x(end, m)] += basis(m, number) * fx;
            f[at<P>.y(end, m)] += basis(m, number) * fy;
        }
        f[at<P>.z(end)] += signed_axial;
        f[at<P>.e(end)] += position(number) * signed_axial;
        couple += point(end, number, Point::lever) * across;
    }

    template <int size>
    void accelerate_ends(const MirroredInverse& inverse, const V* f, int begin) noexcept {
        V product[2 * size];
        multiply_ends<size>(inverse, f + begin, product);
        for (int row = 0; row < 2 * size; ++row) put(g_.acceleration, begin + row, -product[row]);
    }
};

}  // namespace
}  // namespace cvtflow::model
