#include "tests/tasks/tiny_fixture.hpp"

#include <gtest/gtest.h>

#include "bench/study/run_watch.hpp"
#include "tasks/run/run.hpp"
#include "tasks/run/simulation.hpp"
#include "tests/temporary_file_fixture.hpp"

namespace cvtflow::tasks {

Scene brief_scene() {
    Scene scene = read_scene(CVTFLOW_SOURCE_DIR "/scenes/tiny.toml");
    const std::vector<std::string> brief{"start.settling_time=1ms", "start.ramp_time=0.5ms", "run.step=50 ns"};
    set_values(scene, brief);
    return scene;
}

const FrozenStart& brief_start() {
    static const FrozenStart settled = [] {
        Simulation simulation(brief_scene());
        SilentObserver silent;
        const engine::Cancellation never;
        EXPECT_FALSE(simulation.advance({.until = 0.0}, silent, never));
        return bench::frozen_start(simulation);
    }();
    return settled;
}

namespace test {

Scene settled_tiny(const std::vector<std::string>& settings) {
    static const Scene settled = [] {
        Scene scene = read_scene(CVTFLOW_SOURCE_DIR "/scenes/tiny.toml");
        static const cvtflow::tests::TemporaryFile state("settled_tiny");
        const std::string& file = state.path();
        set_values(scene, std::vector<std::string>{"start.settling_time=1ms", "start.ramp_time=0.5ms", "run.schedule=serial"});
        settle_scene(scene, file, {});
        set_values(scene, std::vector<std::string>{"start.state=" + file, "run.until=20us", "run.output_interval=10us",
                                                   "run.state_interval=10us"});
        return scene;
    }();
    Scene scene = settled;
    set_values(scene, settings);
    return scene;
}

}  // namespace test

}  // namespace cvtflow::tasks
