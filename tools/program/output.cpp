#include "tools/program/output.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <utility>

#include "engine/base/text.hpp"
#include "engine/record/run/schema.hpp"
#include "engine/record/run/state_file.hpp"
#include "tasks/run/checkpoint.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::tools {

namespace {

/// Whether a file is a checkpoint that can be resumed.
bool is_checkpoint(const std::string& file) {
    std::error_code absent;
    if (!std::filesystem::is_regular_file(std::filesystem::symlink_status(file, absent))) return false;
    try {
        static_cast<void>(tasks::read_checkpoint(file));
        return true;
    } catch (const engine::RecordError&) {
        return false;
    }
}

}  // namespace

std::string beside(const std::string& file, std::string_view ending) {
    std::string name = file;
    const auto strip = [&name](std::string_view own) {
        const bool more = name.ends_with(own) && std::filesystem::path(name).filename().string().size() > own.size();
        if (more) name.resize(name.size() - own.size());
        return more;
    };
    static_cast<void>(strip(".part"));
    static_cast<void>(strip(".h5") || strip(".csv") || strip(".toml"));
    return name + std::string(ending);
}

engine::OutputFile output_file(const std::string& path, bool named, bool force) {
    const auto finished = [](const std::string& there) {
        const auto permissions = std::filesystem::status(there).permissions();
        return !there.ends_with(".part") && (permissions & std::filesystem::perms::owner_write) != std::filesystem::perms::none;
    };
    return {path, !force && !named && path.starts_with("results/") ? engine::MayReplace(finished) : engine::any_file(force)};
}

std::string replacing(const std::string& path) {
    std::error_code absent;
    return std::filesystem::exists(path, absent) ? path + ": the existing file is replaced" : "";
}

std::string default_place(const std::string& name) {
    std::error_code failed;  // other reasons are reported by what is written, which needs the folder
    std::filesystem::create_directories("results", failed);
    if (failed == std::errc::permission_denied || failed == std::errc::operation_not_permitted ||
        failed == std::errc::read_only_file_system)
        throw engine::RecordError(
            fmt::format("results/{}: cannot create: no permission to create the folder 'results' here (choose a place with -o)", name));
    return "results/" + name;
}

CLI::Option* with_default_place(CLI::Option* option, bool files) {
    return option->transform([files](const std::string& name) {
        const std::filesystem::path there = std::filesystem::path("results") / name;
        std::error_code absent;
        const bool bare = std::filesystem::path(name).filename() == name && !std::filesystem::exists(name, absent);
        if (!bare || !(files ? std::filesystem::is_regular_file(there, absent) : std::filesystem::exists(there, absent))) return name;
        say(false, fmt::format("{}: reading {}", engine::visible(name), engine::visible(there.string())));
        return there.string();
    });
}

void require_checkpoint_place(const std::string& path, const std::vector<std::filesystem::path>& inputs) {
    const auto own = [](const std::string& there) {
        return there.ends_with(".part") ? engine::is_state_file(there) : is_checkpoint(there);
    };
    engine::require_place({path, own, "it is not a checkpoint: move it away"}, inputs);
}

void keep_checkpoint(const std::string& file) {
    if (!is_checkpoint(file)) return;
    throw engine::RecordError(
        fmt::format("{0}: the checkpoint of an unfinished run; cvtflow resume {0} continues it, --force starts again", file));
}

void forget_checkpoint(const std::string& file, const std::vector<std::filesystem::path>& inputs) {
    std::error_code absent;
    for (const std::string& each : {file, file + ".part"})
        for (const std::filesystem::path& input : inputs)
            if (!input.empty() && std::filesystem::equivalent(each, input, absent) && !absent) return;
    if (is_checkpoint(file) || !std::filesystem::exists(std::filesystem::symlink_status(file, absent))) tasks::remove_checkpoint(file);
}

void declare_output(CLI::App& app, OutputArguments& arguments) {
    app.add_option("-o,--output", arguments.folder, "Folder for tables and pictures (default: none; results with --csv, --json or --svg)")
        ->type_name("DIR");
    app.add_flag("--csv", arguments.csv, "Write tables");
    app.add_flag("--json", arguments.json, "Write all results as JSON, with provenance");
    app.add_flag("--svg", arguments.svg, "Write pictures (default with -o: --csv, --json and --svg)");
}

}  // namespace cvtflow::tools
