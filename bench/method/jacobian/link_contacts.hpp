#pragma once
/// Contributions of joints to the rows of a link: the element of model/force, over numbers with derivatives.

#include "bench/method/jacobian/dual_elements.hpp"
#include "bench/method/jacobian/link_rows.hpp"
#include "bench/method/product_names.hpp"
#include "model/force/inner.hpp"

namespace cvtflow::bench {

namespace {

/// Elasticity inside the link, in all of its unknowns at once. state [unknowns of the link]
template <int P>
inline void add_inner(const Coefficients& c, const LinkKind& kind, const double* state, LinkRows<P>& rows) noexcept {
    constexpr int n = LinkRows<P>::size;
    using T = Dual<2 * n>;
    T q[n], v[n], f[n];
    for (int k = 0; k < n; ++k) {
        q[k] = T::variable(state[k], k);
        v[k] = T::variable(state[n + k], n + k);
    }
    NoBooks none;
    const T moment = inner_elasticity<P>(c, kind, link_frame<P>(q, v), q, v, f, none);
    const auto add = [](const T& from, double* row) {
        for (int k = 0; k < 2 * n; ++k) row[LinkRows<P>::column(1, With::position, 0) + k] += from.slope[static_cast<std::size_t>(k)];
    };
    for (int k = 0; k < n; ++k) add(f[k], rows.row(k));
    add(moment, rows.moment_row());
    rows.moment += moment.value;
}

/// Σ c_m P_m(ξ) with the values of one lane. c [coefficients of the axis]
template <int P, int Most>
[[nodiscard]] inline double along_axis(const PointLanes<Most>& points, std::size_t lane, const double* c) noexcept {
    double value = c[0];
    for (std::size_t m = 1; m <= P; ++m) value += c[m] * points.basis[m][lane];
    return value;
}

/// How a force at a point of the axis spreads over a difference of halves, (x_0 … x_P, y_0 … y_P, z, e), and vice versa.
template <int P>
struct PointWeights {
    static constexpr int count = 2 * (P + 1) + 2;
    double x[P + 1];  ///< P_m(ξ) [1]
    double xi;        ///< ξ [1]

    template <class Points>
    PointWeights(const Points& points, std::size_t lane) noexcept : xi(points.position[lane]) {
        x[0] = 1.0;
        for (std::size_t m = 1; m <= P; ++m) x[m] = points.basis[m][lane];
    }
    /// Weight of a coordinate of the difference, and the component of the point that it moves (0 x, 1 y, 2 z).
    [[nodiscard]] double weight(int coordinate) const noexcept {
        if (coordinate < 2 * (P + 1)) return x[coordinate % (P + 1)];
        return coordinate == 2 * (P + 1) ? 1.0 : xi;
    }
    [[nodiscard]] static int component(int coordinate) noexcept { return coordinate < P + 1 ? 0 : coordinate < 2 * (P + 1) ? 1 : 2; }
    /// Place of the coordinate in a link's q.
    [[nodiscard]] static int place(int coordinate, End end) noexcept {
        if (coordinate < P + 1) return link_layout<P>.x(end, coordinate);
        if (coordinate < 2 * (P + 1)) return link_layout<P>.y(end, coordinate - P - 1);
        return coordinate == 2 * (P + 1) ? link_layout<P>.z(end) : link_layout<P>.e(end);
    }
};

/// state [unknowns of the link]
template <int P>
inline void add_plates(const Coefficients& c, const LinkKind& kind, const double* state, LinkRows<P>& rows) noexcept {
    constexpr int n = LinkRows<P>::size;
    using T = Lanes<six>;  // x y z | their rates
    using Weights = PointWeights<P>;
    double local[Weights::count][2 * Weights::count] = {};
    const Difference<P> d(state, End::front, state, End::rear), rate(state + n, End::front, state + n, End::rear);
    for (std::size_t j = 0; j < static_cast<std::size_t>(c.plates.count); ++j) {
        const Weights weights(c.plates, j);
        const auto point = [&](const Difference<P>& of, int first) {  // seen alone, it is a difference of order 0
            Difference<0, T> alone;
            alone.x[0] = T::variable(along_axis<P>(c.plates, j, of.x), first);
            alone.y[0] = T::variable(along_axis<P>(c.plates, j, of.y), first + 1);
            alone.z = T::variable(of.z + weights.xi * of.e, first + 2);
            return alone;
        };
        const auto parts = plate_at(c, kind, static_cast<int>(j), point(d, 0), point(rate, 3));
        for (int r = 0; r < Weights::count; ++r) {
            const T& part = parts[static_cast<std::size_t>(Weights::component(r))];
            for (int k = 0; k < 2 * Weights::count; ++k) {
                const int of = k % Weights::count, direction = Weights::component(of) + (k < Weights::count ? 0 : 3);
                local[r][k] += weights.weight(r) * weights.weight(of) * part.slope[static_cast<std::size_t>(direction)];
            }
        }
    }
    for (int r = 0; r < Weights::count; ++r) {
        for (int k = 0; k < 2 * Weights::count; ++k) {
            const With with = k < Weights::count ? With::position : With::velocity;
            const int of = k % Weights::count;
            const int front = LinkRows<P>::column(1, with, Weights::place(of, End::front)),
                      rear = LinkRows<P>::column(1, with, Weights::place(of, End::rear));
            double* ahead = rows.row(Weights::place(r, End::front));
            double* behind = rows.row(Weights::place(r, End::rear));
            ahead[front] += local[r][k];
            ahead[rear] -= local[r][k];
            behind[front] -= local[r][k];
            behind[rear] += local[r][k];
        }
    }
}

}  // namespace

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
    using T = Lanes<eleven>;  // gx gy | ax ay az | direction and turning of the link before | of the link after
    static constexpr int gaps = 2 * (P + 1), rates = Weights::count, inputs = gaps + rates + 6;

    JointRows(const Coefficients& c, const JointLinks& links, bool of_after) noexcept : of_after_(of_after) {
        constexpr int n = link_layout<P>.link_size();
        const Difference<P> gap(links.state_before, End::front, links.state_after, End::rear);
        const Difference<P> rate(links.state_before + n, End::front, links.state_after + n, End::rear);
        for (std::size_t g = 0; g < static_cast<std::size_t>(c.joint_points.count); ++g) {
            const Weights weights(c.joint_points, g);
            const auto& points = c.joint_points;
            const auto variable = [](double value, int direction) { return T::variable(value, direction); };
            const auto frame = [&](const DualFrame& of, int first) {
                return LinkFrameOf<T>{variable(of.tx.value, first), variable(of.ty.value, first + 1), 0.0,
                                      variable(of.turning.value, first + 2)};
            };
            Difference<0, T> open, opening;  // the point alone: a joint of order 0
            open.x[0] = variable(along_axis<P>(points, g, gap.x), 0);
            open.y[0] = variable(along_axis<P>(points, g, gap.y), 1);
            opening.x[0] = variable(along_axis<P>(points, g, rate.x), 2);
            opening.y[0] = variable(along_axis<P>(points, g, rate.y), 3);
            opening.z = variable(rate.z + weights.xi * rate.e, 4);
            const JointFrames<T> frames(frame(links.frame_before, 5), frame(links.frame_after, 8));
            add_point(weights, joint_at(c, frames, static_cast<int>(g), open, opening));
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
    /// Derivatives of one component of a point, spread over the inputs. factor [1], out [inputs]
    static void spread(const Weights& weights, double factor, const T& part, double* out) noexcept {
        for (int k = 0; k < gaps; ++k) out[k] += factor * weights.weight(k) * part.slope[static_cast<std::size_t>(Weights::component(k))];
        for (int k = 0; k < rates; ++k)
            out[gaps + k] += factor * weights.weight(k) * part.slope[static_cast<std::size_t>(2 + Weights::component(k))];
        for (std::size_t k = 0; k < 6; ++k) out[gaps + rates + static_cast<int>(k)] += factor * part.slope[5 + k];
    }
    /// terms: force on the half in front, its moment along the axis (none at a point), moments on both links
    void add_point(const Weights& weights, const PointOfJoint& terms) noexcept {
        for (int r = 0; r < Weights::count; ++r)
            spread(weights, weights.weight(r), terms[static_cast<std::size_t>(Weights::component(r))], local_[r]);
        const T& moment = terms[of_after_ ? 5 : 4];
        spread(weights, 1.0, moment, local_[Weights::count]);
        moment_ += moment.value;
    }
    /// g [inputs], sign [1], row [LinkRows::width]
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
    double moment_ = 0.0;                            ///< on the link [N·m]
    double local_[Weights::count + 1][inputs] = {};  ///< [force or moment][input]
};

}  // namespace

}  // namespace cvtflow::bench
