#include <fmt/format.h>
#include <zlib.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <cvtflow/cvtflow.hpp>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/hash.hpp"
#include "engine/base/provenance.hpp"
#include "engine/base/text.hpp"
#include "engine/record/run/schema.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/command/record/fmu_description.hpp"
#include "tools/program/embedded.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/program.hpp"
#include "tools/program/text/markup.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

namespace fs = std::filesystem;

/// A part of a ZIP file.
struct ZipPart {
    std::string name;  ///< path with '/' between folders
    std::string bytes;
};

constexpr std::uint16_t zip_version = 20;              // of the format: folders
constexpr std::uint16_t first_of_january_1980 = 0x21;  // a file is the same whenever it is made
constexpr std::uint32_t plain_file = 0100644u << 16;
constexpr std::uint16_t zero = 0, utf_8_names = 0x0800;
constexpr std::uint16_t from_unix = 3 << 8 | zip_version;

constexpr std::size_t longest_readable = 65535;

/// Compressed bytes without zlib's header, as ZIP requires.
std::string deflated(const std::string& bytes) {
    z_stream stream{};
    constexpr int level = 5;  // the library in a third of the time of the best level, 1.4 % larger
    if (deflateInit2(&stream, level, Z_DEFLATED, -MAX_WBITS, MAX_MEM_LEVEL, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
    std::string out(deflateBound(&stream, bytes.size()), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    const int status = deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    if (status != Z_STREAM_END) throw std::runtime_error("zip: zlib cannot compress");
    return out;
}

/// A part as it is in the file.
struct Packed {
    const ZipPart& part;
    bool compressed;
    std::string bytes = compressed ? deflated(part.bytes) : part.bytes;
    std::uint32_t sum =
        static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(part.bytes.data()), static_cast<uInt>(part.bytes.size())));
};

template <class... Number>
void add(std::string& file, Number... numbers) {
    const auto one = [&file](auto number) {
        for (std::size_t byte = 0; byte < sizeof number; ++byte) file += static_cast<char>(number >> 8 * byte & 0xFFu);
    };
    (one(numbers), ...);
}

/// Facts that local header and directory have in common: flags, method, time, date, sum, sizes, lengths.
void add_facts(std::string& file, const Packed& packed) {
    add(file, utf_8_names, packed.compressed ? std::uint16_t{Z_DEFLATED} : zero, zero, first_of_january_1980, packed.sum);
    add(file, static_cast<std::uint32_t>(packed.bytes.size()), static_cast<std::uint32_t>(packed.part.bytes.size()));
    add(file, static_cast<std::uint16_t>(packed.part.name.size()), zero);
}

/// The parts as a ZIP file, compressed; the first, up to 64 KiB, is not, so that its text can be found. Equal bytes for the same parts
/// and version of zlib. @throws std::length_error beyond 2 GiB
std::string zip_file(const std::vector<ZipPart>& parts) {
    std::string file, directory;
    for (const ZipPart& part : parts) {
        if (part.bytes.size() > std::numeric_limits<std::uint32_t>::max() / 2) throw std::length_error("zip: a part of more than 2 GiB");
        const Packed packed{part, !file.empty() || part.bytes.size() > longest_readable};
        const auto begin = static_cast<std::uint32_t>(file.size());
        add(file, std::uint32_t{0x04034B50}, zip_version);
        add_facts(file, packed);
        file += part.name + packed.bytes;
        if (file.size() > std::numeric_limits<std::uint32_t>::max() / 2) throw std::length_error("zip: more than 2 GiB");
        add(directory, std::uint32_t{0x02014B50}, from_unix, zip_version);
        add_facts(directory, packed);
        add(directory, zero, zero, zero, plain_file, begin);
        directory += part.name;
    }
    const auto place = static_cast<std::uint32_t>(file.size());
    file += directory;
    const auto count = static_cast<std::uint16_t>(parts.size());
    add(file, std::uint32_t{0x06054B50}, zero, zero, count, count, static_cast<std::uint32_t>(directory.size()), place, zero);
    return file;
}

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

/// A part of FMUs, if it exists: beside the program as it was built, or in lib/cvtflow or lib/ARCHITECTURE/cvtflow of its
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

/// Reason why the FMU is for Linux only; empty: it is for both. A library for Windows that is older than that for Linux is left out.
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

/// Simulation at t = 0, where a geometric start has settled.
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

std::string rows_of(const std::vector<FmuVariable>& variables) {
    std::string rows;
    for (const FmuVariable& row : variables)
        rows +=
            fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n", html(row.name),
                        row.kind == "flag" ? "output, Boolean" : row.kind, row.unit == "1" ? "" : html(row.unit), html(row.description));
    return rows;
}

std::string documentation_of(const FmuFacts& facts, const std::vector<FmuVariable>& variables, int version) {
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><title>{0}</title></head>\n<body>\n<h1>{0}</h1>\n<p>{1}</p>\n"
        "<p>A chain-driven continuously variable transmission for co-simulation by FMI {2}.0, exported by cvtflow {3}. It runs on the "
        "thread "
        "of its importer. Communication steps may have any length; inputs are constant within a step. The FMU starts from a settled state; "
        "after a change of a parameter it settles again while its initialisation ends.</p>\n"
        "<p>Where the balance of energy does not close, results are wrong: <code>unreliable</code> becomes true, the step in which it does "
        "returns a warning, and the log states the reason.</p>\n{5}{4}<p><a "
        "href=\"licenses/license.txt\">Licences</a></p>\n</body>\n</html>\n",
        html(facts.name), html(facts.description), version, engine::current_provenance().version,
        fmt::format(
            "<table><caption>Variables</caption><thead><tr><th>name</th><th>causality</th><th>unit</th><th>meaning</th></tr></thead>"
            "<tbody>\n{}</tbody></table>\n",
            rows_of(variables)),
        facts.sources.empty() ? ""
                              : fmt::format("<p>sources/ has the library's sources. In that folder, GCC or Clang build it by<br><code>c++ "
                                            "@build.txt -o ../binaries/{}/{}.so</code><br>and with -march=native for this processor: "
                                            "the bits are the same.</p>\n",
                                            version == 2 ? "linux64" : "x86_64-linux", facts.identifier));
}

/// Documents beside the description: a page, licences, an icon. @param version  2 or 3
std::vector<ZipPart> fmu_documents(const FmuFacts& facts, const std::vector<FmuVariable>& variables, int version) {
    const auto file = [](const char* name, const char* of) { return ZipPart{name, std::string(embedded(of))}; };
    std::vector<ZipPart> parts{{"documentation/index.html", documentation_of(facts, variables, version)},
                               {"documentation/licenses/license.txt",
                                fmt::format("{}\n{}\n{}", embedded("LICENSE"), std::string(80, '-'), embedded("licenses.txt"))}};
    if (version == 2) {
        parts.push_back(file("model.png", "fmu_icon.png"));
    } else {
        parts.push_back(file("terminalsAndIcons/icon.png", "fmu_icon.png"));
        parts.push_back(file("terminalsAndIcons/icon.svg", "fmu_icon.svg"));
    }
    return parts;
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

/// Rule for an FMU, which the description, its first part, identifies. A compressed one, with very many variables, identifies nothing.
engine::OutputRule fmu_rule(const FmuArguments& arguments, const tasks::Scene& scene) {
    const std::vector<std::string> marks{"modelDescription.xml", "generationTool=\"cvtflow ",
                                         fmt::format("modelName=\"{}\"", html(scene.name))};
    return scene_rule("FMU of the scene", engine::text_with(marks), scene, !arguments.output.empty(), arguments.force);
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
        fmt::print("{}: FMI {}.0 for co-simulation, {}, {}\n", engine::visible(file), arguments.version,
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
