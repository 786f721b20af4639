/// A simulation by the core library alone. Prints the hash of its state.
///
///     core_program SCENE TIME [LEVEL [KEY=VALUE...]]
///
/// SCENE: name of a ready one, or a file; TIME: to advance to [s]; level of detail; settings

#include <cvtflow/cvtflow.hpp>

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

int main(int count, char** arguments) {
    const std::string name = arguments[1];
    std::ifstream file(name);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    try {
        cvtflow::Scene scene = name.ends_with(".toml") ? cvtflow::Scene::parse(text, name) : cvtflow::Scene::ready(name);
        if (count > 3) scene = scene.with_detail(arguments[3]);
        const std::vector<std::string> settings(arguments + (count > 4 ? 4 : count), arguments + count);
        cvtflow::Simulation simulation(scene.with(settings));
        simulation.advance_to(std::strtod(arguments[2], nullptr));
        std::printf("%016" PRIx64 "\n", simulation.hash());
        return 0;
    } catch (const cvtflow::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
