#include "jacobian_fixture.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::bench {

using bench::Near;
using bench::With;

double entry(const bench::AccelerationJacobian& j, With with, int row, int column) {
    const int n = j.size(), edge = j.links() * n, m = j.border();
    if (row >= edge && column >= edge) return j.corner(with)[(row - edge) * m + column - edge];
    if (row >= edge) return j.rows(column / n, with)[(row - edge) * n + column % n];
    if (column >= edge) return j.columns(row / n, with)[row % n * m + column - edge];
    const int apart = (column / n - row / n + j.links()) % j.links();
    const auto in = [&](Near near) { return j.link(row / n, near, with)[row % n * n + column % n]; };
    if (apart == 0) return in(Near::same);
    if (apart == 1) return in(Near::after);
    return apart == j.links() - 1 ? in(Near::before) : 0.0;
}

namespace {

/// Place in the state of the acceleration (or, as a column, the velocity or coordinate) with this number.
int place(const model::ChainLayout& at, int number, With with) {
    const int edge = at.links * at.link_size();
    const bool velocity = with == With::velocity;
    if (number < edge) return at.link_begin(number / at.link_size()) + (velocity ? at.link_size() : 0) + number % at.link_size();
    const int behind = number - edge - at.pulley_size;
    if (behind >= 0) return velocity ? at.control_begin() + behind : -1;  // I has no coordinate
    return at.pulley_begin() + (velocity ? at.pulley_size : 0) + number - edge;
}

}  // namespace

double largest_difference(const model::ChainLayout& layout, const bench::AccelerationJacobian& jacobian, const std::vector<double>& dense,
                          const std::vector<double>& other) {
    const int edge = layout.links * layout.link_size(), unknowns = edge + jacobian.border();
    double worst = 0.0;
    for (const With with : {With::position, With::velocity}) {
        double error[2][2] = {}, largest[2][2] = {};
        for (int column = 0; column < unknowns; ++column) {
            if (place(layout, column, with) < 0) continue;
            for (int row = 0; row < unknowns; ++row) {
                const auto at = static_cast<std::size_t>(place(layout, column, with) * layout.size() + place(layout, row, With::velocity));
                const auto [low, high] = std::minmax(dense[at], other[at]);
                const double is = entry(jacobian, with, row, column);
                double& e = error[row >= edge][column >= edge];
                e = std::max({e, low - is, is - high});
                largest[row >= edge][column >= edge] = std::max(largest[row >= edge][column >= edge], std::abs(high));
            }
        }
        for (int part = 0; part < 4; ++part) {
            if (largest[part / 2][part % 2] > 0.0) worst = std::max(worst, error[part / 2][part % 2] / largest[part / 2][part % 2]);
        }
    }
    return worst;
}

}  // namespace cvtflow::bench
