#include "tests/tasks/settled_tiny_fixture.hpp"

#include <unistd.h>

#include <filesystem>

#include "tasks/run/run.hpp"

namespace cvtflow::tasks::test {

Scene settled_tiny(const std::vector<std::string>& settings) {
    static const Scene settled = [] {
        Scene scene = read_scene(CVTFLOW_SOURCE_DIR "/scenes/tiny.toml");
        const std::string file =
            (std::filesystem::temp_directory_path() / ("cvtflow_settled_tiny_" + std::to_string(getpid()) + ".h5")).string();
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
