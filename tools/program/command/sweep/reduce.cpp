#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "engine/base/input_file.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/drawing.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/program.hpp"
#include "tools/program/view/described.hpp"

namespace cvtflow::tools {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t largest_axes = 1 << 20;  // bytes

struct ReduceArguments {
    SceneArguments scene;
    std::string folder, axes;
    int threads = 0;
    double margin = 0.1;
};

std::string axes_text(const std::string& file) {
    try {
        return file.empty() ? "" : engine::read_text_input(file, largest_axes);
    } catch (const std::exception& error) {
        throw std::runtime_error(fmt::format("--axes {}: {}", file, error.what()));
    }
}

/// Request to the Python package, which runs sweeps by this program and writes the files.
nlohmann::json request_of(const ReduceArguments& arguments, const char* command) {
    const LoadedScene loaded = load_scene(arguments.scene);
    const std::string folder =
        arguments.folder.empty() ? default_place(fmt::format("{}_{}", loaded.scene.name, command)) : arguments.folder;
    nlohmann::json values;
    for (const tasks::Parameter& key : tasks::parameter_table())
        values[std::string(key.key)] = nlohmann::json::parse(tasks::value_text(key, loaded.scene), nullptr, false);
    return {{"command", command},
            {"known", known_json()},
            {"name", loaded.scene.name},
            {"scene", values},
            {"text", tasks::write_scene(loaded.scene)},
            {"place", folder},
            {"folder", path_for_python(folder)},
            {"program", path_for_python(fs::read_symlink("/proc/self/exe").string())},
            {"axes", axes_text(arguments.axes)},
            {"threads", arguments.threads},
            {"detail", arguments.scene.detail.empty() ? "rigid" : arguments.scene.detail},
            {"margin", arguments.margin}};
}

Action declare(CLI::App& app, const char* command, const char* files) {
    const auto arguments = std::make_shared<ReduceArguments>();
    declare_scene(app, arguments->scene);
    app.add_option("-o,--output", arguments->folder, fmt::format("Folder for {} (default: results/NAME_{})", files, command))
        ->type_name("DIR");
    app.add_option("--axes", arguments->axes, "TOML file of axes, instead of the scene's ranges (docs/reduce.md)")->type_name("FILE");
    app.add_option("--threads", arguments->threads, "Threads of the sweeps (default: all)")->check(CLI::Range(1, 1024))->type_name("COUNT");
    if (command == std::string_view("clamp"))
        app.add_option("--margin", arguments->margin, "Torque that remains to the limit of slip, as a share of the load")
            ->check(CLI::Range(0.0, 3.0))
            ->type_name("NUMBER")
            ->capture_default_str();
    return [arguments, command] {
        const std::string made = drawn(request_of(*arguments, command), true);  // exit status, then lines
        fmt::print("{}", made.substr(made.find('\n') + 1));
        return static_cast<ExitStatus>(std::stoi(made));
    };
}

}  // namespace

Action declare_reduce(CLI::App& app) {
    app.footer(
        "Results of the sweeps stay in the folder: the same line continues after Ctrl-C. Python computes (python3-h5py, python3-scipy for\n"
        "map.mat) and a C compiler makes the FMUs.");
    return declare(app, "reduce", "tables, picture and FMUs");
}

Action declare_clamp(CLI::App& app) {
    app.footer("The table has the clamping forces of best efficiency that keep the margin, beside those of clamping.safety.");
    return declare(app, "clamp", "table and picture");
}

}  // namespace cvtflow::tools
