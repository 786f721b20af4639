#include "settled_fixture.hpp"
#include "bench/study/run_watch.hpp"
#include "tasks/run/simulation.hpp"

#include <gtest/gtest.h>

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

}  // namespace cvtflow::bench
