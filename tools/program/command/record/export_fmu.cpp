#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <cvtflow/cvtflow.hpp>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/hash.hpp"
#include "engine/base/text.hpp"
#include "engine/record/run/schema.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/command/command.hpp"
#include "tools/program/command/record/fmu_description.hpp"
#include "tools/program/command/record/fmu_documents.hpp"
#include "tools/program/command/record/zip_file.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/text/markup.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

namespace fs = std::filesystem;

struct FmuArguments {
    SceneArguments scene;
    std::string output, author;
    FmuChoice choice;
    int version = 3;
    bool sources = false, force = false, quiet = false;
};

std::string bytes_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::error_code error;
    std::string bytes(file ? fs::file_size(path, error) : 0, '\0');  // in one piece: the library has some 7 MB
    if (!file || error || !file.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
        throw engine::RecordError(fmt::format("{}: cannot read: {}", path.string(), error ? error.message() : std::strerror(errno)));
    return bytes;
}

/// A part of FMUs, if it is there: beside the program as it was built, or in lib/cvtflow or lib/ARCHITECTURE/cvtflow of its
/// installation; else empty.
fs::path fmu_part(const char* name) {
    std::error_code unknown;
    const fs::path folder = fs::canonical("/proc/self/exe", unknown).parent_path(), lib = folder.parent_path() / "lib";
    std::vector<fs::path> places{folder / name, lib / "cvtflow" / name};
    for (const fs::directory_entry& entry : fs::directory_iterator(lib, unknown)) places.push_back(entry.path() / "cvtflow" / name);
    const auto found = std::find_if(places.begin(), places.end(), [&](const fs::path& place) { return fs::exists(place, unknown); });
    return found == places.end() ? fs::path() : *found;
}

/// The systems that the FMU is for, with their folders in it.
struct FmuSystem {
    const char *name, *library, *suffix, *folder_2, *folder_3;
    fs::path file = {};
};

std::vector<FmuSystem> fmu_systems() {
    std::vector<FmuSystem> systems{{"Linux", "cvtflow_fmu.so", ".so", "linux64", "x86_64-linux"},
                                   {"Windows", "cvtflow_fmu.dll", ".dll", "win64", "x86_64-windows"}};
    for (FmuSystem& system : systems) system.file = fmu_part(system.library);
    if (systems[0].file.empty())
        throw engine::RecordError(
            fmt::format("{}: found neither beside this program nor in lib/cvtflow of its installation (cmake --build build --target "
                        "cvtflow_fmu; x86-64 only)",
                        systems[0].library));
    return systems;
}

/// Why the FMU is for Linux only; empty: it is for both. A library for Windows that is older than that for Linux may be of other sources.
std::string no_windows(const std::vector<FmuSystem>& systems) {
    if (systems[1].file.empty()) return "no cvtflow_fmu.dll: docs/fmi.md";
    if (fs::last_write_time(systems[1].file) >= fs::last_write_time(systems[0].file)) return "";
    return "cvtflow_fmu.dll is older than cvtflow_fmu.so and is left out: cmake --build build --target cvtflow_fmu_windows";
}

/// A name reduced to letters, digits and underscores: the name of the FMU's library.
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

/// Sources of the library, in the order of their names. @throws RecordError if they are missing
std::vector<ZipPart> fmu_sources() {
    const fs::path folder = fmu_part("cvtflow_fmu_sources");
    if (folder.empty())
        throw engine::RecordError("cvtflow_fmu_sources: found neither beside this program nor in lib/cvtflow of its installation");
    std::vector<ZipPart> parts;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
        if (entry.is_regular_file())
            parts.push_back({"sources/" + entry.path().lexically_relative(folder).generic_string(), bytes_of(entry.path())});
    }
    std::sort(parts.begin(), parts.end(), [](const ZipPart& one, const ZipPart& other) { return one.name < other.name; });
    return parts;
}

/// Names of the sources to compile, relative to sources/.
std::vector<std::string> compiled_sources(const std::vector<ZipPart>& parts) {
    std::vector<std::string> names;
    for (const ZipPart& part : parts) {
        constexpr std::string_view folder = "sources/";
        if (part.name.starts_with("sources/groups/")) names.push_back(part.name.substr(folder.size()));
    }
    return names;
}

std::string fmu_bytes(const FmuArguments& arguments, const std::vector<FmuSystem>& systems, const tasks::Scene& scene,
                      Simulation& simulation) {
    const bool third = arguments.version == 3;
    const std::vector<FmuVariable> variables = fmu_variables(simulation, arguments.choice, third);
    // The state is inside, and the caller's thread is the only one.
    const std::string text = simulation.scene().with("start.state=\"\"").with("run.schedule=\"auto\"").text();
    const auto state = simulation.state();
    const std::string state_bytes(reinterpret_cast<const char*>(state.bytes().data()), state.bytes().size());
    const std::string table = variables_text(variables);
    const std::string token = fmt::format(
        "{{{:016x}}}", engine::Hash().add(std::string_view(text)).add(std::string_view(state_bytes)).add(std::string_view(table)).value());
    std::vector<ZipPart> sources = arguments.sources ? fmu_sources() : std::vector<ZipPart>();
    const FmuFacts facts{scene.name,
                         identifier_of(scene.name),
                         token,
                         scene.description,
                         arguments.author,
                         generation_date(),
                         tasks::latest_end(scene),
                         scene.vehicle.present(),
                         compiled_sources(sources)};
    std::vector<ZipPart> files{
        {"modelDescription.xml", third ? model_description_3(facts, variables) : model_description_2(facts, variables)}};
    for (const FmuSystem& system : systems)
        files.push_back({fmt::format("binaries/{}/{}{}", third ? system.folder_3 : system.folder_2, facts.identifier, system.suffix),
                         bytes_of(system.file)});
    files.push_back({"resources/scene.toml", text});
    files.push_back({"resources/state.bin", state_bytes});
    files.push_back({"resources/variables.txt", table});
    if (third) files.push_back({"terminalsAndIcons/terminalsAndIcons.xml", terminals_text(variables)});
    for (ZipPart& part : fmu_documents(facts, variables, arguments.version)) files.push_back(std::move(part));
    if (arguments.sources) {
        if (third) files.push_back({"sources/buildDescription.xml", build_description(facts)});
        files.push_back({"sources/build.txt", fmt::format("{} -shared -I.\n{}\n", compiler_options, fmt::join(facts.sources, "\n"))});
    }
    for (ZipPart& part : sources) files.push_back(std::move(part));
    return zip_file(files);
}

/// Its description is the first of its parts; one with very many variables is compressed, and known by nothing.
engine::OutputRule fmu_rule(const FmuArguments& arguments, const tasks::Scene& scene) {
    return {
        .what = fmt::format("FMU of the scene '{}'", scene.name),
        .own = engine::text_with({"modelDescription.xml", "generationTool=\"cvtflow ", fmt::format("modelName=\"{}\"", html(scene.name))}),
        .inputs = input_files(scene),
        .force = arguments.force,
        .named = !arguments.output.empty()};
}

ExitStatus export_fmu(const FmuArguments& arguments) {
    const LoadedScene loaded = load_scene(arguments.scene);
    const std::string file = arguments.output.empty() ? loaded.scene.name + ".fmu" : arguments.output;
    if (const std::string wrong = engine::text_problem(arguments.author); !wrong.empty()) throw UsageError("--author: " + wrong);
    const engine::Permit permit(file, fmu_rule(arguments, loaded.scene));
    for (const std::string& notice : {loaded.notice, permit.notice()}) say(arguments.quiet, notice);
    std::vector<FmuSystem> systems = fmu_systems();
    const std::string alone = no_windows(systems);
    if (!alone.empty()) systems.pop_back();
    Simulation simulation = settled(Scene::parse(tasks::write_scene(loaded.scene), loaded.scene.path.string()));
    engine::write_whole(permit, fmu_bytes(arguments, systems, loaded.scene, simulation));
    for (const std::string& notice : simulation.notices()) print_error(notice);
    if (!arguments.quiet)
        fmt::print("{}: FMI {}.0 for co-simulation, {}, {}\n", file, arguments.version,
                   alone.empty() ? "Linux and Windows" : fmt::format("Linux only ({})", alone),
                   size_text(static_cast<double>(fs::file_size(file))));
    return simulation.energy().reliable ? ExitStatus::finished : ExitStatus::unreliable;
}

}  // namespace

Action declare_export_fmu(CLI::App& app) {
    const auto arguments = std::make_shared<FmuArguments>();
    declare_scene(app, arguments->scene);
    app.add_option("-o,--output", arguments->output, "File to write; must not exist (default: SCENE.fmu, replaced with a notice)")
        ->type_name("FILE.fmu");
    app.add_flag("--force", arguments->force, force_meaning);
    app.add_option("--fmi", arguments->version, "Version of the standard, 2 or 3 (default: 3)")
        ->type_name("N")
        ->check(CLI::IsMember({2, 3}));
    app.add_option("--inputs", arguments->choice.inputs, "Inputs by name, separated by commas (default: all inputs of the scene)")
        ->type_name("NAME,...")
        ->delimiter(',');
    app.add_option("--outputs", arguments->choice.outputs, "Channels, separated by commas, or all (default: a dozen)")
        ->type_name("CHANNEL,...")
        ->delimiter(',');
    app.add_option("--parameters", arguments->choice.parameters,
                   "Keys of the machine, separated by commas, or all (default: a dozen); the others stay as exported")
        ->type_name("KEY,...")
        ->delimiter(',');
    app.add_option("--author", arguments->author, "Author in the model description (default: none)")->type_name("NAME");
    app.add_flag("--sources", arguments->sources, "Put the sources of the library into the file too, to be compiled for other systems");
    declare_shortcut(app, arguments->scene, "--method", "run.method", "NAME");
    declare_shortcut(app, arguments->scene, "--step", "run.step", "TIME");
    declare_fresh_start(app, arguments->scene);
    app.add_flag("-q,--quiet", arguments->quiet, "Print errors only");
    app.footer(
        "The FMU needs no library but C's. It begins with the scene's state, or the settled one, and runs on its caller's thread with the "
        "bits of cvtflow run.\nAn instance in which a parameter is changed settles again. docs/fmi.md lists what FMI offers and this FMU "
        "does "
        "not.\n\n" +
        std::string(exit_status_help));
    return [arguments] { return export_fmu(*arguments); };
}

}  // namespace cvtflow::tools
