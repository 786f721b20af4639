#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <cvtflow/cvtflow.hpp>
#include <filesystem>
#include <fstream>
#include <memory>

#include "engine/base/hash.hpp"
#include "engine/record/run/schema.hpp"
#include "tools/program/arguments/scene_arguments.hpp"
#include "tools/program/command/command.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output/fmu/fmu_variables.hpp"
#include "tools/program/output/fmu/model_description.hpp"
#include "tools/program/output/fmu/terminals.hpp"
#include "tools/program/output/fmu/zip_file.hpp"
#include "tools/program/output/output_place.hpp"
#include "tools/program/output/replacing.hpp"
#include "tools/program/output/text_file.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

namespace fs = std::filesystem;

struct FmuArguments {
    SceneArguments scene;
    std::string output;
    FmuChoice choice;
    int version = 3;
    bool force = false, quiet = false;
};

std::string bytes_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::error_code error;
    std::string bytes(file ? fs::file_size(path, error) : 0, '\0');  // in one piece: the library has some 12 MB
    if (!file || error || !file.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
        throw engine::RecordError(fmt::format("{}: cannot read: {}", path.string(), error ? error.message() : std::strerror(errno)));
    return bytes;
}

/// What an FMU runs: beside the program as it was built, or in lib/cvtflow or lib/ARCHITECTURE/cvtflow of its installation.
fs::path fmu_library() {
    constexpr const char* name = "cvtflow_fmu.so";
    std::error_code unknown;
    const fs::path folder = fs::canonical("/proc/self/exe", unknown).parent_path(), lib = folder.parent_path() / "lib";
    std::vector<fs::path> places{folder / name, lib / "cvtflow" / name};
    for (const fs::directory_entry& entry : fs::directory_iterator(lib, unknown)) places.push_back(entry.path() / "cvtflow" / name);
    for (const fs::path& place : places) {
        if (fs::is_regular_file(place, unknown)) return place;
    }
    throw engine::RecordError(fmt::format(
        "{}: not beside this program nor in lib/cvtflow of its installation (cmake --build build --target cvtflow_fmu; x86-64 only)",
        name));
}

/// Letters, digits and underlines of a name, which becomes the library's.
std::string identifier_of(const std::string& name) {
    std::string identifier;
    for (const char letter : name) identifier += std::isalnum(static_cast<unsigned char>(letter)) != 0 ? letter : '_';
    return identifier.empty() || std::isdigit(static_cast<unsigned char>(identifier[0])) != 0 ? "fmu_" + identifier : identifier;
}

/// At t = 0: a geometric start has settled.
Simulation settled(const Scene& scene) {
    Simulation simulation(scene);
    if (simulation.time() < 0.0) simulation.advance_to(0.0);
    return simulation;
}

std::string fmu_bytes(const FmuArguments& arguments, const tasks::Scene& wanted, Simulation& simulation) {
    const bool third = arguments.version == 3;
    const std::vector<FmuVariable> variables = fmu_variables(simulation, arguments.choice, third);
    const std::string text = simulation.scene().with("start.state=\"\"").text();
    const auto state = simulation.state();
    const std::string state_bytes(reinterpret_cast<const char*>(state.bytes().data()), state.bytes().size());
    const std::string table = variables_text(variables);
    FmuFacts facts{wanted.name, identifier_of(wanted.name), "", wanted.description, wanted.run.until, wanted.run.output_interval};
    facts.token = fmt::format(
        "{{{:016x}}}", engine::Hash().add(std::string_view(text)).add(std::string_view(state_bytes)).add(std::string_view(table)).value());
    std::vector<ZipPart> files{
        {"modelDescription.xml", third ? model_description_3(facts, variables) : model_description_2(facts, variables)},
        {fmt::format("binaries/{}/{}.so", third ? "x86_64-linux" : "linux64", facts.identifier), bytes_of(fmu_library())},
        {"resources/scene.toml", text},
        {"resources/state.bin", state_bytes},
        {"resources/variables.txt", table},
    };
    const std::string terminals = third ? terminals_text(variables) : "";  // 2.0 has none
    if (!terminals.empty()) files.push_back({"terminalsAndIcons/terminalsAndIcons.xml", terminals});
    return zip_file(files);
}

ExitStatus export_fmu(const FmuArguments& arguments) {
    const LoadedScene loaded = load_scene(arguments.scene);
    const std::string file = arguments.output.empty() ? loaded.scene.name + ".fmu" : arguments.output;
    require_output(file, {loaded.scene.path});
    const std::string replaced = replacing(file, !arguments.output.empty(), arguments.force);
    for (const std::string& notice : {loaded.notice, replaced}) {
        if (!notice.empty() && !arguments.quiet) print_error(notice);
    }
    Simulation simulation = settled(Scene::parse(tasks::write_scene(loaded.scene), loaded.scene.path.string()));
    write_text(file, fmu_bytes(arguments, loaded.scene, simulation));
    for (const std::string& notice : simulation.notices()) print_error(notice);
    if (!arguments.quiet)
        fmt::print("{}: FMI {}.0 for co-simulation, {}\n", file, arguments.version, size_text(static_cast<double>(fs::file_size(file))));
    return simulation.energy().reliable ? ExitStatus::finished : ExitStatus::unreliable;
}

}  // namespace

Action declare_export_fmu(CLI::App& app) {
    const auto arguments = std::make_shared<FmuArguments>();
    declare_scene(app, arguments->scene);
    app.add_option("-o,--output", arguments->output,
                   "File to write, which must not be there yet (default: SCENE.fmu, replaced with a notice)")
        ->type_name("FILE.fmu");
    app.add_flag("--force", arguments->force, force_meaning);
    app.add_option("--fmi", arguments->version, "Version of the standard, 2 or 3 (default: 3)")
        ->type_name("N")
        ->check(CLI::IsMember({2, 3}));
    app.add_option("--inputs", arguments->choice.inputs, "Inputs by name, separated by commas (default: all that the scene has)")
        ->type_name("NAME,...")
        ->delimiter(',');
    app.add_option("--outputs", arguments->choice.outputs, "Channels, separated by commas (default: all of one number)")
        ->type_name("CHANNEL,...")
        ->delimiter(',');
    declare_shortcut(app, arguments->scene, "--method", "run.method", "NAME");
    declare_shortcut(app, arguments->scene, "--step", "run.step", "TIME");
    declare_fresh_start(app, arguments->scene);
    app.add_flag("-q,--quiet", arguments->quiet, "Print nothing but errors");
    app.footer(
        "The FMU needs no library but C's. It begins with the scene's state, or the settled one, and runs on its caller's thread with the "
        "bits "
        "of cvtflow run.\nNumbers of the machine are parameters; an instance in which one is changed settles anew. docs/fmi.md tells what "
        "the "
        "standard offers and this does not.\n\n" +
        std::string(exit_status_help));
    return [arguments] { return export_fmu(*arguments); };
}

}  // namespace cvtflow::tools
