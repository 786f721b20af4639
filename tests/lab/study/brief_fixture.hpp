#pragma once
/// The smallest scene, settled for a millisecond, as studies of one state begin with it.

#include <gtest/gtest.h>

#include "bench/study/run_watch.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {

[[nodiscard]] inline Scene brief_scene() {
    Scene scene = read_scene(CVTFLOW_SOURCE_DIR "/scenes/tiny.toml");
    const std::vector<std::string> brief{"start.settling_time=1ms", "start.ramp_time=0.5ms", "run.step=50 ns"};
    set_values(scene, brief);
    return scene;
}

/// Settled once per test program.
[[nodiscard]] inline const FrozenStart& brief_start() {
    static const FrozenStart settled = [] {
        Simulation simulation(brief_scene());
        SilentObserver silent;
        const engine::Cancellation never;
        EXPECT_FALSE(simulation.advance({.until = 0.0}, silent, never));
        return bench::frozen_start(simulation);
    }();
    return settled;
}

}  // namespace cvtflow::tasks
