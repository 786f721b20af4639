#pragma once
/// From velocities to slips and from forces to accelerations, lanes over the links of a group. (model/EQUATIONS.md sections 4 to 6)

#include "model/basis/lanes.hpp"
#include "model/force/link_frame.hpp"
#include "model/friction/mirrored.hpp"
#include "model/friction/slip_space.hpp"

namespace cvtflow::model {
namespace {

using SlipV = Lanes<slip_lanes>;

[[nodiscard]] inline SlipV get(const LaneRows& rows, int row) noexcept { return load<slip_lanes>(rows.at(row)); }
inline void put(LaneRows& rows, int row, const SlipV& value) noexcept { value.copy_to(rows.at(row)); }

/// Points: of a joint, a constant for the compiler; 0: read from the space.
template <int P, int Points>
class SlipGeometry {
public:
    using V = SlipV;
    using Tip = SlipGroup::Tip;
    using Point = SlipGroup::Point;
    static constexpr int n = P + 1;

    SlipGeometry(const SlipSpace& space, SlipGroup& group) noexcept : space_(space), c_(space.chain().coefficients()), g_(group) {}

    [[nodiscard]] int points() const noexcept { return Points > 0 ? Points : space_.contacts().points; }
    [[nodiscard]] SlipContacts contacts() const noexcept { return {points()}; }
    [[nodiscard]] static int tip_row(int corner, int row) noexcept { return Tip::count * corner + row; }
    [[nodiscard]] int point_row(End end, int point, int row) const noexcept { return Point::count * ((end == End::rear ? 0 : points()) + point) + row; }

    void gather(const ContactField& field, const Phase* phases) noexcept {
        const int column = g_.first + 1;
        const auto from = [&](int row, int shift) { return load<slip_lanes>(field.columns.at(row, column + shift)); };
        put(g_.frame, 0, from(ContactComponents::frame_x, 0));
        put(g_.frame, 1, from(ContactComponents::frame_y, 0));
        const V inverse_length = from(ContactComponents::inverse_length, 0);
        for (int point = 0; point < points(); ++point) {
            using Joint = ContactComponents::Joint;
            const int row = field.components.joint(point);
            for (const End end : {End::rear, End::front}) {
                const int shift = end == End::rear ? 0 : 1;
                put(g_.joints, point_row(end, point, Point::normal_x), from(row + Joint::normal_x, shift));
                put(g_.joints, point_row(end, point, Point::normal_y), from(row + Joint::normal_y, shift));
                put(g_.joints, point_row(end, point, Point::lever), inverse_length * from(row + (end == End::rear ? Joint::lever_after : Joint::lever_before), shift));
                put(g_.joints, point_row(end, point, Point::grip), from(row + Joint::grip, shift));
            }
        }
        for (int plate = 0; plate < c_.plates.count; ++plate) put(g_.plates, plate, from(field.components.plate(plate), 0));
        g_.touching = false;
        for (int tip = tips_per_link * g_.first; tip < tips_per_link * g_.last; ++tip) g_.touching = g_.touching || phases[tip] != Phase::free;
        if (!g_.touching) return;
        for (int corner = 0; corner < tips_per_link; ++corner) tip(field, corner, inverse_length);
    }

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
            for (int point = 0; point < points(); ++point) joint_slips(end, point, turn, own);
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
            for (int point = 0; point < points(); ++point) add_joint(end, point, f, couple);
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

    [[nodiscard]] V point(End end, int number, int row) const noexcept { return get(g_.joints, point_row(end, number, row)); }
    [[nodiscard]] V tip_value(int corner, int row) const noexcept { return get(g_.tips, tip_row(corner, row)); }

protected:
    const SlipSpace& space_;
    const Coefficients& c_;
    SlipGroup& g_;

private:
    [[nodiscard]] V v(int row) const noexcept { return get(g_.velocity, row); }
    [[nodiscard]] double basis(int m, int point) const noexcept { return c_.joint_points.basis[static_cast<std::size_t>(m)][static_cast<std::size_t>(point)]; }
    [[nodiscard]] double position(int point) const noexcept { return c_.joint_points.position[static_cast<std::size_t>(point)]; }

    /// |d0| θ'
    [[nodiscard]] V turning() const noexcept {
        const V vx = v(at<P>.x(End::front, 0)) - v(at<P>.x(End::rear, 0)), vy = v(at<P>.y(End::front, 0)) - v(at<P>.y(End::rear, 0));
        return get(g_.frame, 0) * vy - get(g_.frame, 1) * vx;
    }

    /// Two tangents of the sheave, whatever the direction of its normal. (Duff et al., J. Comput. Graph. Tech. 6, 2017)
    void tip(const ContactField& field, int corner, const V& inverse_length) noexcept {
        using From = ContactComponents::Tip;
        const int row = field.components.tip(corner);
        const auto from = [&](int number) { return load<slip_lanes>(field.columns.at(row + number, g_.first + 1)); };
        V x = from(From::normal), y = from(From::normal + 1), z = from(From::normal + 2);
        const V scale = 1.0 / sqrt(larger<slip_lanes>(x * x + y * y + z * z, V(1e-300)));
        x = scale * x;
        y = scale * y;
        z = scale * z;
        const V sign = select_greater<slip_lanes>(z, V(0.0), V(1.0), V(-1.0));
        const V a = -1.0 / (sign + z);
        const V b = x * y * a;
        const V tangents[2][3] = {{1.0 + sign * x * x * a, sign * b, -(sign * x)}, {b, sign + y * y * a, -y}};
        for (int k = 0; k < 2; ++k) {
            const V* t = tangents[k];
            for (int axis = 0; axis < 3; ++axis) put(g_.tips, tip_row(corner, Tip::tangent + 3 * k + axis), t[axis]);
            put(g_.tips, tip_row(corner, Tip::lever + k), inverse_length * (t[1] * from(From::lever_x) - t[0] * from(From::lever_y)));
            put(g_.tips, tip_row(corner, Tip::sheave + k), t[0] * from(From::sheave) + t[1] * from(From::sheave + 1) + t[2] * from(From::sheave + 2));
            put(g_.tips, tip_row(corner, Tip::drift + k), t[0] * from(From::drift) + t[1] * from(From::drift + 1) + t[2] * from(From::drift + 2));
        }
        put(g_.tips, tip_row(corner, Tip::grip), from(From::grip));
        put(g_.tips, tip_row(corner, Tip::sticks), select_greater<slip_lanes>(from(From::most), V(1e100), V(0.0), V(1.0)));
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
