#pragma once
/// What plates and inner elasticity add to the rows of a link: the elements of model/force, over numbers with derivatives.

#include "model/force/inner.hpp"
#include "model/jacobian/dual_elements.hpp"
#include "model/jacobian/link_rows.hpp"

namespace cvtflow::model {
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
    const T moment = inner_elasticity<P, false>(c, kind, link_frame<P>(q, v), q, v, f, nullptr);
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
        if (coordinate < P + 1) return at<P>.x(end, coordinate);
        if (coordinate < 2 * (P + 1)) return at<P>.y(end, coordinate - P - 1);
        return coordinate == 2 * (P + 1) ? at<P>.z(end) : at<P>.e(end);
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
}  // namespace cvtflow::model
