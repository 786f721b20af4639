/// A simulation by the core library alone. Prints the hash of its state.
///
///     core_program SCENE.toml TIME        time to advance to [s]

#include <cvtflow/error.hpp>
#include <cvtflow/simulation.hpp>

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

int main(int, char** arguments) {
    std::ifstream file(arguments[1]);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    try {
        cvtflow::Simulation simulation(cvtflow::Scene::parse(text, arguments[1]));
        simulation.advance_to(std::strtod(arguments[2], nullptr));
        std::printf("%016" PRIx64 "\n", simulation.hash());
        return 0;
    } catch (const cvtflow::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
