#pragma once
/// What joints and tips add to the rows of a link, and tips to the pulleys' rows.

#include "model/jacobian/link_contributions.hpp"

namespace cvtflow::model {
namespace {

/// The two links of a joint and their places among the columns: `before` and `before` + 1.
struct JointLinks {
    const double* state_before;  ///< [unknowns of a link]
    const double* state_after;   ///< [unknowns of a link]
    const DualFrame& frame_before;
    const DualFrame& frame_after;
    int before;
};

/// Derivatives of one joint's effect on one of its links: a force on the half, and the moment.
template <int P>
class JointRows {
public:
    using Weights = PointWeights<P>;
    using T = Dual<11>;  // gx gy | ax ay az | direction and turning of the link before | of the link after
    static constexpr int gaps = 2 * (P + 1), rates = Weights::count, inputs = gaps + rates + 6;

    JointRows(const Coefficients& c, const JointLinks& links, bool of_after) noexcept : of_after_(of_after) {
        constexpr int n = at<P>.link_size();
        const Difference<P> gap(links.state_before, End::front, links.state_after, End::rear);
        const Difference<P> rate(links.state_before + n, End::front, links.state_after + n, End::rear);
        for (std::size_t g = 0; g < static_cast<std::size_t>(c.joint_points.count); ++g) {
            const Weights weights(c.joint_points, g);
            const auto& points = c.joint_points;
            const auto &a = links.frame_before, &b = links.frame_after;
            const double values[11] = {along_axis<P>(points, g, gap.x),
                                       along_axis<P>(points, g, gap.y),
                                       along_axis<P>(points, g, rate.x),
                                       along_axis<P>(points, g, rate.y),
                                       rate.z + weights.xi * rate.e,
                                       a.tx.value,
                                       a.ty.value,
                                       a.turning.value,
                                       b.tx.value,
                                       b.ty.value,
                                       b.turning.value};
            T v[11];
            for (int d = 0; d < 11; ++d) v[d] = T::variable(values[d], d);
            add_point(weights,
                      joint_effect<T>(c.joint, points.weight[g], {v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8], v[9], v[10]}));
        }
    }

    void add_to(const JointLinks& links, LinkRows<P>& rows) const noexcept {
        const double sign = of_after_ ? -1.0 : 1.0;
        for (int r = 0; r < Weights::count; ++r)
            add_row(links, local_[r], sign, rows.row(Weights::place(r, of_after_ ? End::rear : End::front)));
        add_row(links, local_[Weights::count], 1.0, rows.moment_row());
        rows.moment += moment_;
    }

private:
    /// Derivatives of one component of a point, spread over the inputs.
    static void spread(const Weights& weights, double factor, const T& part, double* out) noexcept {
        for (int k = 0; k < gaps; ++k) out[k] += factor * weights.weight(k) * part.slope[static_cast<std::size_t>(Weights::component(k))];
        for (int k = 0; k < rates; ++k)
            out[gaps + k] += factor * weights.weight(k) * part.slope[static_cast<std::size_t>(2 + Weights::component(k))];
        for (std::size_t k = 0; k < 6; ++k) out[gaps + rates + static_cast<int>(k)] += factor * part.slope[5 + k];
    }
    void add_point(const Weights& weights, const JointEffect<T>& effect) noexcept {
        const T* parts[3] = {&effect.fx, &effect.fy, &effect.fz};
        for (int r = 0; r < Weights::count; ++r) spread(weights, weights.weight(r), *parts[Weights::component(r)], local_[r]);
        const T& moment = of_after_ ? effect.after : effect.before;
        spread(weights, 1.0, moment, local_[Weights::count]);
        moment_ += moment.value;
    }
    static void add_row(const JointLinks& links, const double* g, double sign, double* row) noexcept {
        const auto add = [&](With with, int k, double value) {
            row[LinkRows<P>::column(links.before, with, Weights::place(k, End::front))] += sign * value;
            row[LinkRows<P>::column(links.before + 1, with, Weights::place(k, End::rear))] -= sign * value;
        };
        for (int k = 0; k < gaps; ++k) add(With::position, k, g[k]);
        for (int k = 0; k < rates; ++k) add(With::velocity, k, g[gaps + k]);
        const double* f = g + gaps + rates;
        LinkRows<P>::add_frame(row, links.before, links.frame_before, sign * f[0], sign * f[1], sign * f[2]);
        LinkRows<P>::add_frame(row, links.before + 1, links.frame_after, sign * f[3], sign * f[4], sign * f[5]);
    }

    bool of_after_;
    double moment_ = 0.0;
    double local_[Weights::count + 1][inputs] = {};
};

/// One tip: how its motion depends on the link's unknowns, and what its effect adds.
template <int P>
class TipRows {
public:
    using T = Dual<24>;  // E, slopes, direction | rates of E, of slopes, turning | motion of the sheave

    /// state [unknowns]
    TipRows(const Coefficients& c, const double* state, const DualFrame& frame, const SheaveMotion& sheave, End end, int side,
            Phase phase) noexcept
        : frame_(frame), end_(end), side_(side) {
        const double sign = side == 0 ? -1.0 : 1.0;
        for (int m = 0; m <= P; ++m) {
            const bool even = m % 2 == 0;
            value_[m] = even ? 1.0 : sign;
            slope_[m] = c.slope_scale * 0.5 * m * (m + 1) * (even ? sign : 1.0);
        }
        effect_ = tip_effect<T>(c, point_of(c, state, sheave, sign), phase);
    }

    void add_to(LinkRows<P>& rows) const noexcept {
        double own[LinkRows<P>::width];
        const auto expanded = [&](const T& part) { return expand(part, own); };
        for (const bool x : {true, false}) {
            const auto place = [&](int m) { return x ? at<P>.x(end_, m) : at<P>.y(end_, m); };
            expanded(x ? effect_.force.x : effect_.force.y);
            for (int m = 0; m <= P; ++m) add(value_[m], own, rows.row(place(m)));
            expanded(x ? effect_.tilt_x : effect_.tilt_y);
            for (int m = 1; m <= P; ++m) add(slope_[m], own, rows.row(place(m)));
        }
        expanded(effect_.force.z);
        add(1.0, own, rows.row(at<P>.z(end_)));
        add(value_sign(), own, rows.row(at<P>.e(end_)));
        expanded(effect_.moment);
        add(1.0, own, rows.moment_row());
        rows.moment += effect_.moment.value;
    }

    /// Rows of the pulleys on this link, and the effect of the sheave's own motion on it.
    void add_to_sheave(const ExactJacobian::SheaveMap& sheave, int link, AccelerationJacobian& out,
                       SheaveStiffness& stiffness) const noexcept {
        constexpr int n = LinkRows<P>::size;
        double own[LinkRows<P>::width];
        for (std::size_t load = 0; load < 6; ++load) {
            expand(effect_.sheave[load], own);
            for (const auto& effect : sheave.effects[load]) {
                for (const With with : {With::position, With::velocity}) {
                    double* row = out.rows(link, with) + effect.coordinate * n;
                    for (int k = 0; k < n; ++k) row[k] += effect.factor * own[LinkRows<P>::column(1, with, k)];
                }
            }
            for (std::size_t d = 0; d < sheave_directions; ++d) stiffness[load][d] += effect_.sheave[load].slope[13 + d];
        }
    }

private:
    [[nodiscard]] double value_sign() const noexcept { return side_ == 0 ? -1.0 : 1.0; }

    /// state [unknowns], sign [1]
    [[nodiscard]] TipPoint<T> point_of(const Coefficients& c, const double* state, const SheaveMotion& s, double sign) const noexcept {
        const auto sum = [&](const double* x, const double* weights) {
            double total = 0.0;
            for (int m = 0; m <= P; ++m) total += weights[m] * x[m];
            return total;
        };
        const double* q = state;
        const double* v = state + LinkRows<P>::size;
        const int x = at<P>.x(end_, 0), y = at<P>.y(end_, 0), z = at<P>.z(end_), e = at<P>.e(end_);
        // clang-format off
        const double values[24] = {sum(q + x, value_), sum(q + y, value_), q[z] + sign * (c.half_length + q[e]), sum(q + x, slope_), sum(q + y, slope_),
            frame_.tx.value, frame_.ty.value,
            sum(v + x, value_), sum(v + y, value_), v[z] + sign * v[e], sum(v + x, slope_), sum(v + y, slope_), frame_.turning.value,
            s.x, s.y, s.z, s.tilt_x, s.tilt_y, s.vx, s.vy, s.vz, s.spin_x, s.spin_y, s.spin_z};
        // clang-format on
        T d[24];
        for (int k = 0; k < 24; ++k) d[k] = T::variable(values[k], k);
        // clang-format off
        return {sign, {d[0], d[1], d[2]}, d[3], d[4], d[5], d[6], {d[7], d[8], d[9]},
            d[10], d[11], d[12], {d[13], d[14], d[15]}, d[16], d[17], {d[18], d[19], d[20]}, {d[21], d[22], d[23]}};
        // clang-format on
    }

    /// Derivatives of one number with respect to the link's own unknowns and its sheaves' motion.
    void expand(const T& part, double* out) const noexcept {
        using Rows = LinkRows<P>;
        std::memset(out + Rows::column(1, With::position, 0), 0, 2 * Rows::size * sizeof(double));
        std::memset(out + Rows::sheaves_at, 0, 2 * sheave_directions * sizeof(double));
        const auto& g = part.slope;
        for (const With with : {With::position, With::velocity}) {
            const std::size_t first = with == With::position ? 0 : 7, tilt = with == With::position ? 3 : 10;
            const auto to = [&](int coordinate) -> double& { return out[Rows::column(1, with, coordinate)]; };
            for (int m = 0; m <= P; ++m) {
                to(at<P>.x(end_, m)) = value_[m] * g[first] + slope_[m] * g[tilt];
                to(at<P>.y(end_, m)) = value_[m] * g[first + 1] + slope_[m] * g[tilt + 1];
            }
            to(at<P>.z(end_)) = g[first + 2];
            to(at<P>.e(end_)) = value_sign() * g[first + 2];
        }
        Rows::add_frame(out, 1, frame_, g[5], g[6], g[12]);
        for (std::size_t d = 0; d < sheave_directions; ++d) out[Rows::sheave_column(side_, static_cast<int>(d))] = g[13 + d];
    }
    static void add(double factor, const double* from, double* row) noexcept {
        using Rows = LinkRows<P>;
        for (int k = Rows::column(1, With::position, 0); k < Rows::column(2, With::position, 0); ++k) row[k] += factor * from[k];
        for (int k = Rows::sheaves_at; k < Rows::width; ++k) row[k] += factor * from[k];
    }

    const DualFrame& frame_;
    End end_;
    int side_;
    double value_[P + 1], slope_[P + 1];  ///< weights of coordinates in E, and in the slopes times slope_scale
    TipEffect<T> effect_{};
};

}  // namespace
}  // namespace cvtflow::model
