#include "tests/tasks/tiny_fixture.hpp"

#include "tasks/run/run.hpp"
#include "tests/temporary_file_fixture.hpp"

namespace cvtflow::tasks::test {

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

}  // namespace cvtflow::tasks::test
