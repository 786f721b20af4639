#pragma once
/// Derivatives of one link's generalized forces with respect to its own unknowns, those of its two neighbours, and the motion of its
/// sheaves: rows of forces and one of the moment about z, filled contribution by contribution.

#include <cstring>

#include "bench/method/jacobian/dual_lanes.hpp"
#include "bench/method/jacobian/exact_jacobian.hpp"
#include "bench/method/product_names.hpp"
#include "model/force/link_frame.hpp"
#include "model/machine/link_inertia.hpp"

namespace cvtflow::bench {
namespace {

/// Frame of a link, differentiated in (dx, dy, vx, vy), the difference of its halves and its rate.
using DualFrame = LinkFrameOf<Dual<4>>;

template <int P>
class LinkRows {
public:
    static constexpr int size = link_layout<P>.link_size();
    static constexpr int sheaves_at = 6 * size;
    static constexpr int width = 6 * size + 2 * sheave_directions;

    /// Column of an unknown. @param link 0 before, 1 itself, 2 after
    [[nodiscard]] static constexpr int column(int link, With with, int coordinate) noexcept {
        return (2 * link + static_cast<int>(with)) * size + coordinate;
    }
    [[nodiscard]] static constexpr int sheave_column(int side, int direction) noexcept {
        return sheaves_at + side * sheave_directions + direction;
    }

    [[nodiscard]] double* row(int coordinate) noexcept { return rows_[coordinate]; }
    [[nodiscard]] double* moment_row() noexcept { return rows_[size]; }
    double moment = 0.0;  ///< value of the moment [N·m]

    /// row += g_tx ∂tx + g_ty ∂ty + g_w ∂θ' with respect to the coordinates and velocities of a link with this frame. row [width]
    static void add_frame(double* row, int link, const DualFrame& frame, double g_tx, double g_ty, double g_turning) noexcept {
        for (std::size_t d = 0; d < 4; ++d)
            add_difference(row, link, static_cast<int>(d),
                           g_tx * frame.tx.slope[d] + g_ty * frame.ty.slope[d] + g_turning * frame.turning.slope[d]);
    }

    /// The moment as a couple on the m = 0 coordinates; after all contributions.
    void fold_moment(const DualFrame& frame) noexcept {
        const Dual<4> cx = -(frame.inverse_length * frame.ty), cy = frame.inverse_length * frame.tx;
        add_couple(link_layout<P>.x(End::front, 0), 1.0, cx);
        add_couple(link_layout<P>.y(End::front, 0), 1.0, cy);
        add_couple(link_layout<P>.x(End::rear, 0), -1.0, cx);
        add_couple(link_layout<P>.y(End::rear, 0), -1.0, cy);
    }

    /// Forces to accelerations.
    void accelerate(const LinkInertia& inertia) noexcept {
        constexpr int lateral = 2 * (P + 1);
        solve<lateral>(inertia.lateral, 0);
        solve<lateral>(inertia.lateral, lateral);
        solve<4>(inertia.axial, 2 * lateral);
    }

private:
    /// row [width]
    static void add_difference(double* row, int link, int direction, double value) noexcept {
        const With with = direction < 2 ? With::position : With::velocity;
        const bool x = direction % 2 == 0;
        row[column(link, with, x ? link_layout<P>.x(End::front, 0) : link_layout<P>.y(End::front, 0))] += value;
        row[column(link, with, x ? link_layout<P>.x(End::rear, 0) : link_layout<P>.y(End::rear, 0))] -= value;
    }
    /// sign [1]
    void add_couple(int coordinate, double sign, const Dual<4>& arm) noexcept {
        double* out = rows_[coordinate];
        for (int k = 0; k < width; ++k) out[k] += sign * arm.value * rows_[size][k];
        for (int d = 0; d < 4; ++d) add_difference(out, 1, d, sign * moment * arm.slope[static_cast<std::size_t>(d)]);
    }
    /// N rows by their products with an inverse.
    template <int N>
    void solve(const SmallInverse& inverse, int first) noexcept {
        double products[N][width] = {};
        for (int k = 0; k < N; ++k) {
            for (int r = 0; r < N; ++r) {
                const double factor = inverse.column[static_cast<std::size_t>(k * padded(N) + r)];
                for (int c = 0; c < width; ++c) products[r][c] += factor * rows_[first + k][c];
            }
        }
        std::memcpy(rows_[first], products, sizeof products);
    }

    double rows_[size + 1][width] = {};  ///< [force or moment][unknown]
};

}  // namespace
}  // namespace cvtflow::bench
