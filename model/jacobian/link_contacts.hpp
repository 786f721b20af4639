#pragma once
/// What joints add to the rows of a link: the element of model/force, over numbers with derivatives.

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
    using T = Lanes<eleven>;  // gx gy | ax ay az | direction and turning of the link before | of the link after
    static constexpr int gaps = 2 * (P + 1), rates = Weights::count, inputs = gaps + rates + 6;

    JointRows(const Coefficients& c, const JointLinks& links, bool of_after) noexcept : of_after_(of_after) {
        constexpr int n = at<P>.link_size();
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
}  // namespace cvtflow::model
