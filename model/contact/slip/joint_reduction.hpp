#pragma once
/// Cyclic reduction of a ring of joints, lanes over its stretches: what two neighbours have of each other comes in, one solution per joint
/// goes out. (model/contact/slip/joint_chain.hpp)

#include <algorithm>
#include <cstdint>
#include <span>

#include "model/contact/slip/slip_tiles.hpp"
#include "model/machine/coefficients.hpp"

namespace cvtflow::model {
namespace {

/// Points: of a joint, a constant for the compiler; 0: read from the chain.
template <int Points>
class JointReduction {
public:
    using F = FloatLanes;

    /// @param chain with the right-hand sides of all joints   @param elements of every group's links, first stretches first
    /// @param late 1 in lanes whose stretch begins at joint 1
    JointReduction(SlipChain& chain, std::span<const FloatRows* const> elements, const F& late) noexcept
        : c_(chain), elements_(elements), late_(late) {}

    void solve() noexcept {
        copy(*elements_[0], c_.left);
        const F never(0.0f);
        for (int joint = 1; joint < length(); ++joint) {
            condense(*elements_[static_cast<std::size_t>(joint)], side(joint), joint == 1 ? late_ : never, joint > 1,
                     c_.steps[static_cast<std::size_t>(joint - 1)]);
        }
        if (length() > 1) {
            for (int row = 0; row < size(); ++row) put(c_.sides, row, choose(late_, get(c_.sides, size() + row), get(c_.sides, row)));
        }
        ring();
        for (int row = 0; row < size(); ++row) {
            put(c_.unknowns, row, get(c_.ends, row));
            next_lane(c_.unknowns.at(row), c_.unknowns.at(length() * size() + row), c_.stretches.count());
        }
        for (int joint = length() - 1; joint >= 1; --joint) {
            substitute(c_.steps[static_cast<std::size_t>(joint - 1)], c_.unknowns.at(0), c_.unknowns.at((joint + 1) * size()),
                       joint == 1 ? late_ : never, c_.unknowns.at(joint * size()));
        }
    }

private:
    static constexpr int most = 2 * (Points > 0 ? Points : max_joint_lanes);

    [[nodiscard]] int size() const noexcept { return Points > 0 ? 2 * Points : c_.size; }
    [[nodiscard]] int length() const noexcept { return c_.stretches.length(); }
    [[nodiscard]] SlipElement element() const noexcept { return {size()}; }
    [[nodiscard]] SlipStep step() const noexcept { return {size()}; }
    [[nodiscard]] const float* side(int joint) const noexcept { return c_.sides.at(joint * size()); }
    /// What joints have of each other falls with every joint between them, down to where processors take a hundred times as long.
    [[nodiscard]] static F not_tiny(const F& value) noexcept { return select_greater(larger(value, -value), 1e-12f, value, 0.0f); }
    [[nodiscard]] static F choose(const F& flag, const F& yes, const F& no) noexcept { return select_greater(flag, 0.5f, yes, no); }
    void copy(const FloatRows& from, FloatRows& to) const noexcept { std::copy_n(from.at(0), element().count() * slip_lanes, to.at(0)); }

    /// To each lane what the next one has; from the last to the first.
    static void next_lane(const float* from, float* to, int count) noexcept {
        for (int lane = 0; lane < slip_lanes; ++lane) to[lane] = from[lane + 1 < count ? lane + 1 : 0];
    }

    /// left ← left and right together, the joint between them being eliminated. Where there is no left one, it is the right one.
    /// @param side right-hand side of that joint   @param missing 1 in lanes without a left element; none: whether there are no such lanes
    void condense(const FloatRows& right, const float* side, const F& missing, bool none, FloatRows& to) noexcept {
        const int n = size();
        float* panel = to.at(step().panel(0, 0));
        const auto entry = [&](int row, int column) { return panel + (row * width() + column) * slip_lanes; };
        F m[triangle(most, 0)];
        for (int row = 0; row < n; ++row) {
            for (int column = 0; column <= row; ++column)
                m[triangle(row, column)] =
                    get(c_.left, element().front() + row * n + column) + get(right, element().rear() + row * n + column);
            m[triangle(row, row)] = 1.0f + m[triangle(row, row)];
            for (int column = 0; column < n; ++column) {
                get(c_.left, element().across() + row * n + column).copy_to(entry(row, column));
                get(right, element().across() + column * n + row).copy_to(entry(row, n + column));
            }
            (get(c_.left, element().front_side() + row) + get(right, element().rear_side() + row) + load(side + row * slip_lanes))
                .copy_to(entry(row, 2 * n));
        }
        factorise(m);
        forward(m, panel);
        for (int k = 0; k < triangle(n, 0); ++k) put(to, k, m[k]);
        for (int row = 0; row < n; ++row) {
            for (int column = 0; column < width(); ++column)
                put(c_.scaled, row * width() + column, m[triangle(row, row)] * load(entry(row, column)));
        }
        reduce(right, panel);
        if (none) return;
        for (int row = 0; row < element().count(); ++row) put(c_.left, row, choose(missing, get(right, row), get(c_.left, row)));
    }
    [[nodiscard]] int width() const noexcept { return 2 * size() + 1; }
    void factorise(F* m) const noexcept {
        if constexpr (Points > 0)
            ldl<2 * Points>(m);
        else
            ldl(m, size());
    }

    /// L⁻¹ x in place.
    void forward(const F* m, float* x) const noexcept {
        for (int row = 1; row < size(); ++row) {
            F own[2 * most + 1];
            float* to = x + row * width() * slip_lanes;
            for (int column = 0; column < width(); ++column) own[column] = load(to + column * slip_lanes);
            for (int k = 0; k < row; ++k) {
                const F by = m[triangle(row, k)];
                for (int column = 0; column < width(); ++column)
                    own[column] = own[column] - by * load(x + (k * width() + column) * slip_lanes);
            }
            for (int column = 0; column < width(); ++column) own[column].copy_to(to + column * slip_lanes);
        }
    }

    /// @param x panel of the step
    void reduce(const FloatRows& right, const float* x) noexcept {
        const int n = size();
        const float *y = c_.scaled.at(0), *next = x + n * slip_lanes;
        const auto subtract = [&]<bool Lower>(const float* a, const float* b, const float* from, float* to) {
            subtract_products<2 * Points, tile_rows<Points>, tile_columns<Points>, Lower>(a, width(), b, width(), n, n, from, to, n);
        };
        subtract.template operator()<true>(x, y, c_.left.at(element().rear()), c_.left.at(element().rear()));
        subtract.template operator()<false>(next, y, nullptr, c_.left.at(element().across()));
        subtract.template operator()<true>(next, y + n * slip_lanes, right.at(element().front()), c_.left.at(element().front()));
        for (int k = 0; k < n * n; ++k) put(c_.left, element().across() + k, not_tiny(get(c_.left, element().across() + k)));
        for (int row = 0; row < n; ++row) {
            F rear = get(c_.left, element().rear_side() + row), front = get(right, element().front_side() + row);
            for (int k = 0; k < n; ++k) {
                const F side = get(c_.scaled, k * width() + 2 * n);
                rear = rear - load(x + (k * width() + row) * slip_lanes) * side;
                front = front - load(next + (k * width() + row) * slip_lanes) * side;
            }
            put(c_.left, element().rear_side() + row, rear);
            put(c_.left, element().front_side() + row, front);
        }
    }

    /// x of an eliminated joint from those before and after it; where there was none before, that one's.
    void substitute(const FloatRows& from, const float* before, const float* next, const F& missing, float* to) const noexcept {
        F y[most];
        for (int row = 0; row < size(); ++row) y[row] = get(from, step().panel(row, 2 * size()));
        for (int k = 0; k < size(); ++k) {
            const F x_before = load(before + k * slip_lanes), x_next = load(next + k * slip_lanes);
            for (int row = 0; row < size(); ++row)
                y[row] = y[row] - get(from, step().panel(row, k)) * x_before - get(from, step().panel(row, size() + k)) * x_next;
        }
        back_substitute(y, size(), [&](int row, int column) { return get(from, step().factor(row, column)); });
        for (int row = 0; row < size(); ++row) choose(missing, load(before + row * slip_lanes), y[row]).copy_to(to + row * slip_lanes);
    }

    /// The joints between stretches: elements in pairs, until one is left. Of an odd number the first has no partner before it.
    void ring() noexcept {
        float* sides = c_.sides.at(0);
        for (int level = 0; level < c_.levels(); ++level) {
            const int count = c_.counts[static_cast<std::size_t>(level)], odd = count % 2,
                      fewer = c_.counts[static_cast<std::size_t>(level) + 1];
            alignas(64) float between[most * slip_lanes];
            alignas(64) std::int32_t first[slip_lanes], second[slip_lanes];
            for (int lane = 0; lane < slip_lanes; ++lane) {
                first[lane] = std::clamp(2 * lane - odd, 0, count - 1);
                second[lane] = std::clamp(2 * lane + 1 - odd, 0, count - 1);
            }
            for (int row = 0; row < size(); ++row) {
                permute(sides + row * slip_lanes, second, fewer, between + row * slip_lanes);
                permute(sides + row * slip_lanes, first, fewer, sides + row * slip_lanes);
            }
            for (int row = 0; row < element().count(); ++row) {
                permute(c_.left.at(row), second, fewer, c_.right.at(row));
                permute(c_.left.at(row), first, fewer, c_.left.at(row));
            }
            condense(c_.right, between, without_first(odd), odd == 0, c_.steps[static_cast<std::size_t>(length() - 1 + level)]);
        }
        last();
        for (int level = c_.levels() - 1; level >= 0; --level) expand(level);
    }
    [[nodiscard]] static F without_first(int odd) noexcept {
        alignas(64) float flags[slip_lanes] = {};
        flags[0] = odd != 0 ? 1.0f : 0.0f;
        return load(flags);
    }

    /// One element whose ends are one joint, in lane 0.
    void last() noexcept {
        F m[triangle(most, 0)], x[most];
        for (int row = 0; row < size(); ++row) {
            for (int column = 0; column <= row; ++column) {
                const int own = row * size() + column, turned = column * size() + row;
                m[triangle(row, column)] = (get(c_.left, element().rear() + own) + get(c_.left, element().front() + own)) +
                                           (get(c_.left, element().across() + own) + get(c_.left, element().across() + turned));
            }
            m[triangle(row, row)] = 1.0f + m[triangle(row, row)];
            x[row] = get(c_.sides, row) + get(c_.left, element().rear_side() + row) + get(c_.left, element().front_side() + row);
        }
        factorise(m);
        for (int row = 0; row < size(); ++row) {
            for (int k = 0; k < row; ++k) x[row] = x[row] - m[triangle(row, k)] * x[k];
        }
        for (int row = size() - 1; row >= 0; --row) {
            x[row] = x[row] * m[triangle(row, row)];
            for (int k = row + 1; k < size(); ++k) x[row] = x[row] - m[triangle(k, row)] * x[k];
        }
        for (int row = 0; row < size(); ++row) put(c_.ends, c_.levels() * size() + row, x[row]);
    }

    /// From the joints of a level to those of the one before.
    void expand(int level) noexcept {
        const int count = c_.counts[static_cast<std::size_t>(level)], odd = count % 2,
                  fewer = c_.counts[static_cast<std::size_t>(level) + 1];
        const float* before = c_.ends.at((level + 1) * size());
        alignas(64) float next[most * slip_lanes], between[most * slip_lanes];
        for (int row = 0; row < size(); ++row) next_lane(before + row * slip_lanes, next + row * slip_lanes, fewer);
        substitute(c_.steps[static_cast<std::size_t>(length() - 1 + level)], before, next, without_first(odd), between);
        for (int row = 0; row < size(); ++row) {
            float* to = c_.ends.at(level * size() + row);
            for (int lane = 0; lane < count; ++lane)
                to[lane] = ((lane + odd) % 2 == 0 ? before : between)[row * slip_lanes + (lane + odd) / 2];
        }
    }

    SlipChain& c_;
    std::span<const FloatRows* const> elements_;
    F late_;
};

}  // namespace
}  // namespace cvtflow::model
