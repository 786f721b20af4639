#include "jacobian_fixture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bench/study/run_watch.hpp"
#include "tasks/run/simulation.hpp"

namespace cvtflow::bench {
namespace {

Scene tiny_with(const std::vector<std::string>& extra) {
    Scene scene = read_scene(CVTFLOW_SOURCE_DIR "/scenes/tiny.toml");
    std::vector<std::string> values{"start.settling_time=0.6ms", "start.ramp_time=0.3ms"};
    values.insert(values.end(), extra.begin(), extra.end());
    set_values(scene, values);
    return scene;
}

FrozenStart settled(const Scene& scene) {
    Simulation simulation(scene);
    SilentObserver silent;
    const engine::Cancellation never;
    EXPECT_FALSE(simulation.advance({.until = 0.0}, silent, never));
    return frozen_start(simulation);
}

}  // namespace

Settled::Settled(const std::vector<std::string>& extra)
    : scene_(tiny_with(extra)),
      variator_(scene_.parameters),
      start_(settled(scene_)),
      slope_(start_.state.size()),
      scratch_(variator_.layout()) {
    evaluate();
}

void Settled::evaluate() {
    model::right_hand_side(variator_, start_.time, start_.state.data(), start_.phases.data(), slope_.data(), scratch_);
}

BasePoint Settled::base() const {
    return {start_.time, start_.state.data(), slope_.data(), start_.phases.data(), scratch_.loads.data(), scratch_.accounts.data()};
}

void Settled::stir(double amount) {
    const model::ChainLayout& at = variator_.layout();
    unsigned random = 1;
    const auto next = [&] { return amount * (static_cast<double>((random = random * 1664525u + 1013904223u) >> 8) / 8388608.0 - 1.0); };
    for (int link = 0; link < at.links; ++link) {
        for (int k = at.link_size(); k < at.link_block(); ++k) start_.state[static_cast<std::size_t>(at.link_begin(link) + k)] += next();
    }
    evaluate();
}

std::vector<double> Settled::dense(double sign) const {
    const model::ChainLayout& at = variator_.layout();
    const std::size_t n = start_.state.size();
    model::EvaluationScratch scratch(at);
    std::vector<double> moved = start_.state, slope(n), matrix(n * n);
    for (std::size_t k = 0; k < n; ++k) {
        const int index = static_cast<int>(k);
        const bool chain = index < at.pulley_begin();
        const bool position = chain ? index % at.link_block() < at.link_size() : index < at.pulley_begin() + at.pulley_size;
        moved[k] += sign * (position ? ColouredJacobian::position_step : ColouredJacobian::velocity_step);
        model::right_hand_side(variator_, start_.time, moved.data(), start_.phases.data(), slope.data(), scratch);
        for (std::size_t row = 0; row < n; ++row) matrix[k * n + row] = (slope[row] - slope_[row]) / (moved[k] - start_.state[k]);
        moved[k] = start_.state[k];
    }
    return matrix;
}

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
