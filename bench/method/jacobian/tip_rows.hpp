#pragma once
/// Contributions of tips to the rows of a link and of the pulleys: the element of model/force, over numbers with derivatives.

#include <cstring>

#include "bench/method/jacobian/dual_elements.hpp"
#include "bench/method/jacobian/link_rows.hpp"
#include "bench/method/product_names.hpp"

namespace cvtflow::bench {
namespace {

/// One tip: how its motion depends on the link's unknowns, and what it does.
/// Seen from its tip, the axis of a pin half is a straight line, that is one of order 1: its coefficients c_0, c_1 along x and y, and z at
/// its end, are what the tip depends on.
template <int P>
class TipRows {
public:
    using T = Lanes<two_dozen>;
    enum Direction { x0, x1, y0, y1, z, tx, ty, rate_x0, rate_x1, rate_y0, rate_y1, rate_z, turning, first_of_sheave };

    /// state [unknowns]
    TipRows(const Coefficients& c, const double* state, const DualFrame& frame, const SheaveMotion& sheave, End end, int side,
            Phase phase) noexcept
        : frame_(frame), end_(end), sign_(side == 0 ? -1.0 : 1.0), side_(side) {
        for (int m = 0; m <= P; ++m) {
            const bool even = m % 2 == 0;
            value_[m] = even ? 1.0 : sign_;
            slope_[m] = 0.5 * m * (m + 1) * (even ? sign_ : 1.0);
            start_[m] = value_[m] - sign_ * slope_[m];
        }
        T q[link_layout<1>.link_size()], v[link_layout<1>.link_size()];
        straight(state, x0, q);
        straight(state + LinkRows<P>::size, rate_x0, v);
        const LinkFrameOf<T> of_link{T::variable(frame.tx.value, tx), T::variable(frame.ty.value, ty), 0.0,
                                     T::variable(frame.turning.value, turning)};
        const auto tip = side == 0 ? tip_at<0> : tip_at<1>;
        effect_ = tip(c, of_link, q, v, moving(sheave), phase);
    }

    void add_to(LinkRows<P>& rows) const noexcept {
        double own[LinkRows<P>::width];
        const auto expanded = [&](const T& part) { expand(part, own); };
        for (const bool along_x : {true, false}) {
            const auto place = [&](int m) { return along_x ? link_layout<P>.x(end_, m) : link_layout<P>.y(end_, m); };
            expanded(along_x ? effect_.action.total.x : effect_.action.total.y);
            for (int m = 0; m <= P; ++m) add(value_[m], own, rows.row(place(m)));
            expanded(along_x ? effect_.action.tilt_x : effect_.action.tilt_y);
            for (int m = 1; m <= P; ++m) add(slope_[m], own, rows.row(place(m)));
        }
        expanded(effect_.action.total.z);
        add(1.0, own, rows.row(link_layout<P>.z(end_)));
        add(sign_, own, rows.row(link_layout<P>.e(end_)));
        expanded(effect_.action.moment);
        add(1.0, own, rows.moment_row());
        rows.moment += effect_.action.moment.value;
    }

    /// Rows of the pulleys on this link, and the effect of the sheave's own motion on it.
    void add_to_sheave(const ExactJacobian::SheaveMap& sheave, int link, AccelerationJacobian& out,
                       SheaveStiffness& stiffness) const noexcept {
        constexpr int n = LinkRows<P>::size;
        const T* loads[6] = {&effect_.reaction.force.x,  &effect_.reaction.force.y, &effect_.reaction.moment.x,
                             &effect_.reaction.moment.y, &effect_.reaction.force.z, &effect_.reaction.moment.z};
        double own[LinkRows<P>::width];
        for (std::size_t load = 0; load < 6; ++load) {
            expand(*loads[load], own);
            for (const auto& effect : sheave.effects[load]) {
                for (const With with : {With::position, With::velocity}) {
                    double* row = out.rows(link, with) + effect.coordinate * n;
                    for (int k = 0; k < n; ++k) row[k] += effect.factor * own[LinkRows<P>::column(1, with, k)];
                }
            }
            for (std::size_t d = 0; d < sheave_directions; ++d) stiffness[load][d] += loads[load]->slope[first_of_sheave + d];
        }
    }

private:
    /// The half's coordinates or velocities as those of a link of order 1. from [coordinates of the link], first: direction of x0
    void straight(const double* from, int first, T* to) const noexcept {
        const auto sum = [](const double* x, const double* weights) {
            double total = 0.0;
            for (int m = 0; m <= P; ++m) total += weights[m] * x[m];
            return total;
        };
        const double *along_x = from + link_layout<P>.x(end_, 0), *along_y = from + link_layout<P>.y(end_, 0);
        to[link_layout<1>.x(End::rear, 0)] = T::variable(sum(along_x, start_), first + x0);
        to[link_layout<1>.x(End::rear, 1)] = T::variable(sum(along_x, slope_), first + x1);
        to[link_layout<1>.y(End::rear, 0)] = T::variable(sum(along_y, start_), first + y0);
        to[link_layout<1>.y(End::rear, 1)] = T::variable(sum(along_y, slope_), first + y1);
        to[link_layout<1>.z(End::rear)] = T::variable(from[link_layout<P>.z(end_)] + sign_ * from[link_layout<P>.e(end_)], first + z);
    }

    [[nodiscard]] static SheaveLanes<T> moving(const SheaveMotion& s) noexcept {
        const double values[sheave_directions] = {s.x, s.y, s.z, s.tilt_x, s.tilt_y, s.vx, s.vy, s.vz, s.spin_x, s.spin_y, s.spin_z};
        T d[sheave_directions];
        for (int k = 0; k < sheave_directions; ++k) d[k] = T::variable(values[k], first_of_sheave + k);
        return {{d[0], d[1], d[2]}, d[3], d[4], {d[5], d[6], d[7]}, {d[8], d[9], d[10]}};
    }

    /// Derivatives of one number with respect to the link's own unknowns and its sheaves' motion.
    void expand(const T& part, double* out) const noexcept {
        using Rows = LinkRows<P>;
        std::memset(out + Rows::column(1, With::position, 0), 0, 2 * Rows::size * sizeof(double));
        std::memset(out + Rows::sheaves_at, 0, 2 * sheave_directions * sizeof(double));
        const auto& g = part.slope;
        for (const With with : {With::position, With::velocity}) {
            const std::size_t first = with == With::position ? 0 : rate_x0;
            const auto to = [&](int coordinate) -> double& { return out[Rows::column(1, with, coordinate)]; };
            for (int m = 0; m <= P; ++m) {
                to(link_layout<P>.x(end_, m)) = start_[m] * g[first + x0] + slope_[m] * g[first + x1];
                to(link_layout<P>.y(end_, m)) = start_[m] * g[first + y0] + slope_[m] * g[first + y1];
            }
            to(link_layout<P>.z(end_)) = g[first + z];
            to(link_layout<P>.e(end_)) = sign_ * g[first + z];
        }
        Rows::add_frame(out, 1, frame_, g[tx], g[ty], g[turning]);
        for (std::size_t d = 0; d < sheave_directions; ++d) out[Rows::sheave_column(side_, static_cast<int>(d))] = g[first_of_sheave + d];
    }
    static void add(double factor, const double* from, double* row) noexcept {
        using Rows = LinkRows<P>;
        for (int k = Rows::column(1, With::position, 0); k < Rows::column(2, With::position, 0); ++k) row[k] += factor * from[k];
        for (int k = Rows::sheaves_at; k < Rows::width; ++k) row[k] += factor * from[k];
    }

    const DualFrame& frame_;
    End end_;
    double sign_;  ///< of the side [1]
    int side_;
    double value_[P + 1], slope_[P + 1];  ///< weights of coordinates in the end of the axis, and in its slope over slope_scale [1]
    double start_[P + 1];                 ///< weights of coordinates in c_0 of the straight line [1]
    TipEffect effect_;
};

}  // namespace
}  // namespace cvtflow::bench
