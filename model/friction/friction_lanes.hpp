#pragma once
/// Friction of all contacts as a function of velocities, lanes over links. (model/EQUATIONS.md sections 4 to 7)
/// Every lane does the same operations in the same order whatever its neighbours are, so results do not depend on how links are grouped.

#include "model/force/link_frame.hpp"
#include "model/friction/contact_field.hpp"
#include "model/friction/friction.hpp"

namespace cvtflow::model {
namespace {

/// W links side by side. Column numbers count from the first link of the range.
template <int P, int W, bool Steepest>
class FrictionLanes {
public:
    using V = Lanes<W>;
    using Joint = ContactComponents::Joint;
    using Tip = ContactComponents::Tip;
    static constexpr int n = P + 1;
    /// Rows of a joint's force: x_0…x_p, y_0…y_p, z, e, moment before, moment after.
    static constexpr int joint_rows = 2 * n + 4;

    FrictionLanes(const FrictionOperator& friction, const ContactField& field, const FrictionRange& range) noexcept
        : friction_(friction), c_(friction.chain().coefficients()), field_(field), range_(range), joint_stride_(FrictionOperator::joint_stride(range.last - range.first)) {}

    /// Joint of the rear pins of links first + own … + W - 1, to scratch.
    void joints(int own) const noexcept {
        V gap_x[n], gap_y[n];
        for (int m = 0; m < n; ++m) {
            gap_x[m] = velocity(at<P>.x(End::front, m), own - 1) - velocity(at<P>.x(End::rear, m), own);
            gap_y[m] = velocity(at<P>.y(End::front, m), own - 1) - velocity(at<P>.y(End::rear, m), own);
        }
        const V gap_z = velocity(at<P>.z(End::front), own - 1) - velocity(at<P>.z(End::rear), own);
        const V gap_e = velocity(at<P>.e(End::front), own - 1) - velocity(at<P>.e(End::rear), own);
        const V before = turning(own - 1), after = turning(own);
        V force[joint_rows];
        for (V& row : force) row = V(0.0);
        for (int g = 0; g < field_.components.joint_points; ++g) {
            const int row = field_.components.joint(g);
            const V nx = contact(row + Joint::normal_x, own), ny = contact(row + Joint::normal_y, own);
            const V lever_before = contact(row + Joint::lever_before, own), lever_after = contact(row + Joint::lever_after, own);
            V ax = gap_x[0], ay = gap_y[0];
            for (int m = 1; m < n; ++m) {
                ax += basis(c_.joint_points, m, g) * gap_x[m];
                ay += basis(c_.joint_points, m, g) * gap_y[m];
            }
            const double xi = c_.joint_points.position[static_cast<std::size_t>(g)];
            const V slip = nx * ay - ny * ax + before * lever_before + after * lever_after;
            const V axial = gap_z + xi * gap_e;
            const V grip = contact(row + Joint::grip, own) * factor(c_.joint.friction, slip * slip + axial * axial);
            const V across = -grip * slip, along = -grip * axial;
            const V fx = -across * ny, fy = across * nx;
            force[0] += fx;
            force[n] += fy;
            for (int m = 1; m < n; ++m) {
                force[m] += basis(c_.joint_points, m, g) * fx;
                force[n + m] += basis(c_.joint_points, m, g) * fy;
            }
            force[2 * n] += along;
            force[2 * n + 1] += xi * along;
            force[2 * n + 2] += across * lever_before;
            force[2 * n + 3] += across * lever_after;
        }
        for (int row = 0; row < joint_rows; ++row) store(force[row], range_.scratch + row * joint_stride_ + own);
    }

    /// Slopes of links first + own … + W - 1; their joints must be in scratch.
    void links(int own, const Columns* base, Columns& slope, double weight, Columns* impulses) const noexcept {
        V f[at<P>.link_size()];
        add_joints(own, f);
        V moment = joint(2 * n + 3, own) + joint(2 * n + 2, own + 1);
        plates(own, f);
        if (touching(own)) tips(own, f, moment, weight, impulses);
        const V couple = moment * contact(ContactComponents::inverse_length, own);
        const V tx = contact(ContactComponents::frame_x, own), ty = contact(ContactComponents::frame_y, own);
        f[at<P>.x(End::front, 0)] = f[at<P>.x(End::front, 0)] - couple * ty;
        f[at<P>.y(End::front, 0)] += couple * tx;
        f[at<P>.x(End::rear, 0)] += couple * ty;
        f[at<P>.y(End::rear, 0)] = f[at<P>.y(End::rear, 0)] - couple * tx;
        accelerate(own, f, base, slope);
    }

private:
    static void store(const V& lanes, double* to) noexcept { lanes.copy_to(to); }
    [[nodiscard]] int column(int own) const noexcept { return range_.first + own + 1; }
    [[nodiscard]] V velocity(int row, int own) const noexcept { return load<W>(range_.velocity + row * range_.stride + own + 1); }
    [[nodiscard]] V contact(int row, int own) const noexcept { return load<W>(field_.columns.at(row, column(own))); }
    [[nodiscard]] V joint(int row, int own) const noexcept { return load<W>(range_.scratch + row * joint_stride_ + own); }
    template <int Most>
    [[nodiscard]] static double basis(const PointLanes<Most>& points, int m, int point) noexcept {
        return points.basis[static_cast<std::size_t>(m)][static_cast<std::size_t>(point)];
    }

    [[nodiscard]] V turning(int own) const noexcept {
        const V vx = velocity(at<P>.x(End::front, 0), own) - velocity(at<P>.x(End::rear, 0), own);
        const V vy = velocity(at<P>.y(End::front, 0), own) - velocity(at<P>.y(End::rear, 0), own);
        return (contact(ContactComponents::frame_x, own) * vy - contact(ContactComponents::frame_y, own) * vx) * contact(ContactComponents::inverse_length, own);
    }

    [[nodiscard]] static V factor(const FrictionCurve& curve, const V& square) noexcept {
        if constexpr (Steepest) return V(1.0 / curve.saturation_speed);
        return slip_factor<W>(curve, sqrt(square));
    }

    /// s(v/v0) sign v of a sliding velocity along one axis: without division where the law is piecewise.
    [[nodiscard]] static V held(const FrictionCurve& curve, const V& speed) noexcept {
        const V share = (1.0 / curve.saturation_speed) * speed;
        if (Steepest) return share;
        if (curve.smoothing != 0.0) return slip_factor<W>(curve, abs(speed)) * speed;
        return larger<W>(smaller<W>(share, V(1.0)), V(-1.0));
    }

    void add_joints(int own, V* f) const noexcept {
        for (int m = 0; m < n; ++m) {
            f[at<P>.x(End::rear, m)] = -joint(m, own);
            f[at<P>.y(End::rear, m)] = -joint(n + m, own);
            f[at<P>.x(End::front, m)] = joint(m, own + 1);
            f[at<P>.y(End::front, m)] = joint(n + m, own + 1);
        }
        f[at<P>.z(End::rear)] = -joint(2 * n, own);
        f[at<P>.e(End::rear)] = -joint(2 * n + 1, own);
        f[at<P>.z(End::front)] = joint(2 * n, own + 1);
        f[at<P>.e(End::front)] = joint(2 * n + 1, own + 1);
    }

    void plates(int own, V* f) const noexcept {
        const V gap_z = velocity(at<P>.z(End::front), own) - velocity(at<P>.z(End::rear), own);
        const V gap_e = velocity(at<P>.e(End::front), own) - velocity(at<P>.e(End::rear), own);
        V fz(0.0), fe(0.0);
        for (int j = 0; j < field_.components.plates; ++j) {
            const double xi = c_.plates.position[static_cast<std::size_t>(j)];
            const V sliding = gap_z + xi * gap_e;
            const V slide = contact(field_.components.plate(j), own) * held(c_.plate_friction, sliding);
            fz += slide;
            fe += xi * slide;
        }
        f[at<P>.z(End::front)] = f[at<P>.z(End::front)] - fz;
        f[at<P>.e(End::front)] = f[at<P>.e(End::front)] - fe;
        f[at<P>.z(End::rear)] += fz;
        f[at<P>.e(End::rear)] += fe;
    }

    /// Whether a tip of the links side by side touches.
    [[nodiscard]] bool touching(int own) const noexcept {
        const Phase* phases = range_.phases + tips_per_link * (range_.first + own);
        bool any = false;
        for (int tip = 0; tip < tips_per_link * W; ++tip) any = any || phases[tip] != Phase::free;
        return any;
    }

    void tips(int own, V* f, V& moment, double weight, Columns* impulses) const noexcept {
        const V turn = turning(own);
        for (const End end : {End::rear, End::front}) {
            for (int side = 0; side < 2; ++side) tip(own, end, side, turn, f, moment, weight, impulses);
        }
    }

    void tip(int own, End end, int side, const V& turn, V* f, V& moment, double weight, Columns* impulses) const noexcept {
        const double s = side == 0 ? -1.0 : 1.0;
        const int corner = 2 * static_cast<int>(end) + side;
        const int row = field_.components.tip(corner);
        const V gx = contact(row + Tip::normal, own), gy = contact(row + Tip::normal + 1, own), gz = contact(row + Tip::normal + 2, own);
        const V lever_x = contact(row + Tip::lever_x, own), lever_y = contact(row + Tip::lever_y, own);
        V vx = velocity(at<P>.x(end, 0), own), vy = velocity(at<P>.y(end, 0), own);
        for (int m = 1; m < n; ++m) {
            const double value = m % 2 == 0 ? 1.0 : s;
            vx += value * velocity(at<P>.x(end, m), own);
            vy += value * velocity(at<P>.y(end, m), own);
        }
        V vz = velocity(at<P>.z(end), own) + s * velocity(at<P>.e(end), own);
        vx = vx - turn * lever_y;
        vy += turn * lever_x;
        if constexpr (!Steepest) {
            vx = vx - contact(row + Tip::sheave, own) - range_.time * contact(row + Tip::drift, own);
            vy = vy - contact(row + Tip::sheave + 1, own) - range_.time * contact(row + Tip::drift + 1, own);
            vz = vz - contact(row + Tip::sheave + 2, own) - range_.time * contact(row + Tip::drift + 2, own);
        }
        const V along = vx * gx + vy * gy + vz * gz;
        vx = vx - along * gx;
        vy = vy - along * gy;
        vz = vz - along * gz;
        const V grip = -contact(row + Tip::grip, own) * tip_factor(row, own, vx * vx + vy * vy + vz * vz);
        const V fx = grip * vx, fy = grip * vy, fz = grip * vz;
        for (int m = 0; m < n; ++m) {
            const double value = m % 2 == 0 ? 1.0 : s;
            f[at<P>.x(end, m)] += value * fx;
            f[at<P>.y(end, m)] += value * fy;
        }
        f[at<P>.z(end)] += fz;
        f[at<P>.e(end)] += s * fz;
        moment += lever_x * fy - lever_y * fx;
        if (impulses == nullptr) return;
        add(weight * fx, impulses->at(3 * corner, column(own)));
        add(weight * fy, impulses->at(3 * corner + 1, column(own)));
        add(weight * fz, impulses->at(3 * corner + 2, column(own)));
    }

    [[nodiscard]] V tip_factor(int row, int own, const V& square) const noexcept {
        if (Steepest || !friction_.by_phase()) return factor(c_.tip.friction, square);
        const V least = contact(row + Tip::least, own), most = contact(row + Tip::most, own);
        return V(1.0) / larger<W>(smaller<W>(sqrt(square), most), least);
    }

    static void add(const V& lanes, double* to) noexcept { store(load<W>(to) + lanes, to); }

    void accelerate(int own, const V* f, const Columns* base, Columns& slope) const noexcept {
        const double* lateral = friction_.lateral_inverse().data();
        for (int axis = 0; axis < 2; ++axis) {
            const V* force = f + axis * 2 * n;
            for (int row = 0; row < 2 * n; ++row) solve_row(own, 2 * n, lateral + row * 2 * n, force, axis * 2 * n + row, base, slope);
        }
        const double* axial = friction_.axial_inverse().data();
        for (int row = 0; row < 4; ++row) solve_row(own, 4, axial + row * 4, f + 4 * n, 4 * n + row, base, slope);
    }

    void solve_row(int own, int size, const double* inverse, const V* force, int row, const Columns* base, Columns& slope) const noexcept {
        V value = inverse[0] * force[0];
        for (int k = 1; k < size; ++k) value += inverse[k] * force[k];
        if (base != nullptr) value += load<W>(base->at(row, column(own)));
        store(value, slope.at(row, column(own)));
    }

    const FrictionOperator& friction_;
    const Coefficients& c_;
    const ContactField& field_;
    const FrictionRange& range_;
    int joint_stride_;
};

}  // namespace
}  // namespace cvtflow::model
