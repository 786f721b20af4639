// A host that uses OpenMP: a parameter study, one simulation per iteration of a parallel loop. The results are the same bits as those of
// the serial loop that follows, whatever the number of threads.
//
//     host_openmp [CASES]

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cvtflow/cvtflow.hpp>
#include <string>
#include <vector>

namespace {

struct Case {
    double load = 0.0;  // [N m]
    double slip = 0.0;  // [1]
    std::uint64_t hash = 0;
    std::string error;
};

void run(const cvtflow::Scene& scene, Case& one) {
    try {
        cvtflow::Simulation simulation(scene);
        simulation.set_input(cvtflow::Input::load_torque, one.load);
        simulation.advance_to(1e-3);
        one.slip = simulation.channel("slip")[0];
        one.hash = simulation.hash();
    } catch (const cvtflow::Error& error) {  // no exception may leave an iteration
        one.error = error.what();
    }
}

}  // namespace

int main(int argc, char** argv) try {
    const int count = argc > 1 ? std::atoi(argv[1]) : 6;
    const std::vector<std::string> settings{"run.method=dumka3-p5", "run.step=1 us", "start.settling_time=2 ms", "start.ramp_time=1 ms"};
    const cvtflow::Scene scene = cvtflow::Scene::ready("tiny").with(settings);
    std::vector<Case> parallel(static_cast<std::size_t>(count));
    for (int k = 0; k < count; ++k) parallel[static_cast<std::size_t>(k)].load = 2.0 + 4.0 * k;
    std::vector<Case> serial = parallel;

#pragma omp parallel for schedule(dynamic)
    for (int k = 0; k < count; ++k) run(scene, parallel[static_cast<std::size_t>(k)]);
    for (Case& one : serial) run(scene, one);

    int different = 0;
    std::printf("  load [N m]   slip [%%]   state\n");
    for (std::size_t k = 0; k < parallel.size(); ++k) {
        const Case& one = parallel[k];
        const bool same = one.hash == serial[k].hash && one.error == serial[k].error;
        different += same ? 0 : 1;
        if (one.error.empty()) {
            std::printf("  %10.1f   %8.4f   %016llx%s\n", one.load, 100.0 * one.slip, static_cast<unsigned long long>(one.hash),
                        same ? "" : "  differs from the serial loop");
        } else {
            std::printf("  %10.1f   %s\n", one.load, one.error.c_str());
        }
    }
    std::printf("%s\n", different == 0 ? "parallel and serial: the same bits" : "parallel and serial differ");
    return different;
} catch (const cvtflow::Error& error) {
    std::fprintf(stderr, "host_openmp: %s\n", error.what());
    return 1;
}
