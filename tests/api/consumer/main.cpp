// Simulates a ready scene of the installation.
#include <cstdio>
#include <cvtflow/cvtflow.hpp>

int main() try {
    cvtflow::Simulation simulation(cvtflow::Scene::ready("tiny").with("run.step=100 ns"));
    simulation.advance_to(simulation.time() + 1e-6);
    std::printf("cvtflow %s: t = %g s, %zu unknowns\n", cvtflow::library_version().c_str(), simulation.time(), simulation.size());
    return cvtflow::shutdown() ? 0 : 1;
} catch (const cvtflow::Error& error) {
    std::fprintf(stderr, "%s: %s\n", cvtflow::error_name(error.code()), error.what());
    return 1;
}
