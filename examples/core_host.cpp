/// A host that has no threads, files or other libraries: a time step of 1 ms, an input from outside, and two futures of one state.
/// Links cvtflow::core or cvtflow::core_shared (package cvtflow-core).
///
///     core_host SCENE.toml
#include <cstdio>
#include <cvtflow/error.hpp>
#include <cvtflow/simulation.hpp>
#include <fstream>
#include <iterator>
#include <string>

int main(int count, char** arguments) try {
    if (count < 2) return 2;
    std::ifstream file(arguments[1]);  // the host reads its own files; the library takes text
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const cvtflow::Scene scene =
        cvtflow::Scene::parse(text, arguments[1]).with("start.state=\"\"").with("start.settling_time=5 ms").with_detail("rigid");
    cvtflow::Simulation now(scene);
    now.advance_to(0.0);  // settles
    now.advance_to(1e-3);

    cvtflow::Simulation future = now.copy();  // costs less than a millisecond
    future.set_input(cvtflow::Input::load_torque, 1.1 * now.input(cvtflow::Input::load_torque));
    for (cvtflow::Simulation* each : {&now, &future}) {
        each->advance_to(2e-3);
        std::printf("load %6.2f N m: slip %.6f\n", each->input(cvtflow::Input::load_torque), each->channel("slip")[0]);
    }
    return 0;
} catch (const cvtflow::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
