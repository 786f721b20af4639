#pragma once
/// Pins side by side: their states, the lines between them, their halves, and the links made of those.
/// (model/EQUATIONS.md section 10)

#include "model/kernels/lanes/link_lanes.hpp"
#include "model/kernels/pins/pin_rows.hpp"
#include "model/variator/chain_model.hpp"

namespace cvtflow::model {
namespace {

/// Columns count from the first pin that was read.
template <int P, int W>
class PinMotion {
public:
    using V = Lanes<W>;
    static constexpr int size = pin_at<P>.link_size(), block = pin_at<P>.link_block();

    explicit PinMotion(const JointCoefficients& joint) noexcept : joint_(joint) {}

    /// Reads the blocks of `count` neighbouring pins; columns up to a vector beyond repeat the last one.
    void read(const double* blocks, int count) noexcept {
        for (int column = 0; column < count + W - 1; column += W) {
            std::array<const double*, W> from;
            for (int lane = 0; lane < W; ++lane) from[static_cast<std::size_t>(lane)] = blocks + std::min(column + lane, count - 1) * block;
            std::array<V, block> rows;
            for (int begin = 0; begin < block; begin += W) {  // the last ones twice where they are no whole number of vectors
                const int row = std::min(begin, block - W);
                std::array<const double*, W> of_row;
                std::transform(from.begin(), from.end(), of_row.begin(), [row](const double* pin) { return pin + row; });
                load_rows<W, W>(of_row, rows.data() + row);
            }
            for (int row = 0; row < block; ++row) rows_.put(row, column, rows[static_cast<std::size_t>(row)]);
        }
    }

    /// Velocities of the pins at, …; v [size]
    void velocities(int at, V* v) const noexcept {
        for (int row = 0; row < size; ++row) v[row] = get(size + row, at);
    }

    /// Lines from the pins [first, last) to the ones that follow.
    void lines(int first, int last) noexcept {
        over_columns<W>(first, last, [&](int at) {
            const auto step = [&](int row) {
                return Plane<V>{get(row + x, at + 1) - get(row + x, at), get(row + y, at + 1) - get(row + y, at)};
            };
            const PitchLine<V> line = pitch_line<V>(step(0), step(size));
            rows_.put(along_row, at, line.along);
            rows_.put(inverse_row, at, line.inverse_length);
            rows_.put(turning_row, at, line.turning);
        });
    }
    [[nodiscard]] PitchLine<V> line(int at) const noexcept {
        return {rows_.template plane<W>(along_row, at), get(inverse_row, at), get(turning_row, at)};
    }

    /// Halves of the pins [first, last).
    void roll(int first, int last) noexcept {
        over_columns<W>(first, last, [&](int at) {
            const Rolling<V> r = rolling<V>(joint_.diameter, joint_.arm, line(at - 1), line(at));
            rows_.put(reach_row, at, r.reach);
            rows_.put(reach_rate_row, at, r.reach_rate);
            rows_.put(bisector_row, at, r.bisector);
            rows_.put(pin_turning_row, at, r.turning);
            rows_.put(bending_row, at, r.bending);
            rows_.put(derivative_row, at, r.xx);
            rows_.put(derivative_row + 1, at, r.xy);
            rows_.put(derivative_row + 2, at, r.yy);
        });
    }
    [[nodiscard]] Plane<V> bisector(int at) const noexcept { return rows_.template plane<W>(bisector_row, at); }
    [[nodiscard]] V bending(int at) const noexcept { return get(bending_row, at); }
    /// (∂u/∂s) g.
    [[nodiscard]] Plane<V> derived(int at, const Plane<V>& g) const noexcept {
        const V xy = get(derivative_row + 1, at);
        return {get(derivative_row, at) * g.x + xy * g.y, xy * g.x + get(derivative_row + 2, at) * g.y};
    }

    /// The links behind the pins at, … as those of halves, seen from those pins: what is small is not lost in where the chain is.
    void link_columns(int at, LinkColumns<P, W>& columns) const noexcept {
        const auto half = [&](End end, int pin, double side) {
            for (int rate = 0; rate < 2; ++rate) {
                V* to = columns.state.data() + rate * LinkColumns<P, W>::size;
                copy(pin, rate, end, to);
                if (rate == 0) {
                    to[model::at<P>.x(end, 0)] = get(x, pin) - get(x, at);
                    to[model::at<P>.y(end, 0)] = get(y, pin) - get(y, at);
                }
                const Plane<V> reach = rows_.template plane<W>(rate == 0 ? reach_row : reach_rate_row, pin);
                to[model::at<P>.x(end, 0)] += side * reach.x;
                to[model::at<P>.y(end, 0)] += side * reach.y;
            }
        };
        half(End::rear, at, -0.5);
        half(End::front, at + 1, 0.5);
        columns.frame = link_frame<P>(columns.q(), columns.v());
    }

    /// The pins at, … as both halves of links, which turn as the pins do: for their tips.
    void pin_as_link(int at, LinkColumns<P, W>& columns) const noexcept {
        for (int rate = 0; rate < 2; ++rate) {
            for (const End end : {End::rear, End::front}) copy(at, rate, end, columns.state.data() + rate * LinkColumns<P, W>::size);
        }
        const Plane<V> b = bisector(at);
        columns.frame = {b.x, b.y, V(0.0), get(pin_turning_row, at)};
    }

private:
    static constexpr int x = pin_at<P>.x(End::rear, 0), y = pin_at<P>.y(End::rear, 0);
    static constexpr int along_row = block, inverse_row = along_row + 2, turning_row = inverse_row + 1, reach_row = turning_row + 1,
                         reach_rate_row = reach_row + 2, bisector_row = reach_rate_row + 2, pin_turning_row = bisector_row + 2,
                         bending_row = pin_turning_row + 1, derivative_row = bending_row + 1, rows = derivative_row + 3;

    [[nodiscard]] V get(int row, int at) const noexcept { return rows_.template get<W>(row, at); }

    /// Coordinates (rate 0) or velocities (1) of the pins at, … to those of one end of a link.
    void copy(int pin, int rate, End end, V* to) const noexcept {
        const int from = rate * size;
        for (int m = 0; m <= P; ++m) {
            to[model::at<P>.x(end, m)] = get(from + pin_at<P>.x(End::rear, m), pin);
            to[model::at<P>.y(end, m)] = get(from + pin_at<P>.y(End::rear, m), pin);
        }
        to[model::at<P>.z(end)] = get(from + pin_at<P>.z(End::rear), pin);
        to[model::at<P>.e(end)] = get(from + pin_at<P>.e(End::rear), pin);
    }

    const JointCoefficients& joint_;
    PinRows<rows> rows_;
};

}  // namespace
}  // namespace cvtflow::model
