#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "engine/base/hash.hpp"
#include "engine/base/text.hpp"
#include "engine/record/run/part_file.hpp"
#include "engine/record/run/run_reader.hpp"
#include "engine/record/run/state_file.hpp"
#include "tasks/batch/batch.hpp"
#include "tools/program/command/sweep/batch.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/program.hpp"
#include "tools/program/text/scene_text.hpp"
#include "tools/program/text/text.hpp"
#include "tools/program/view/recorded_run.hpp"
#include "tools/program/view/sweep_view.hpp"

namespace cvtflow::tools {

namespace {

std::string last_text(const std::vector<double>& last) {
    const FiniteFigures figures(last);
    if (std::isnan(figures.mean)) return last.empty() ? "" : "undefined";
    return last.size() == 1 ? fmt::format("{:.6g}", last.front()) : fmt::format("{:.6g} ... {:.6g}", figures.least, figures.largest);
}

std::string channels_text(const engine::RunReader& run) {
    Table table({{"channel"}, {"unit"}, {"shape", Align::right}, {"last"}});
    for (const engine::ChannelInfo& channel : run.channels()) {
        const std::string shape = channel.width > 1 ? fmt::format("{} x {}", run.rows(), channel.width) : fmt::format("{}", run.rows());
        table.add({channel.name, channel.unit, shape, last_text(run.last(channel.name))});
    }
    return "\n" + table.text(2);
}

std::string tables_text(const engine::RunReader& run) {
    Table table({{"table"}, {"rows", Align::right}, {"columns"}, {"description"}});
    for (const engine::TableInfo& info : run.tables()) {
        std::vector<std::string> columns;
        for (const engine::TableColumn& column : info.columns) columns.push_back(column.name);
        table.add(
            {info.name, fmt::format("{}", run.table(info.name).size()), fmt::format("{}", fmt::join(columns, " ")), info.description});
    }
    return run.tables().empty() ? "" : "\n" + table.text(2);
}

std::string span_text(const std::vector<double>& times) {
    const std::string count = count_text(static_cast<long>(times.size()));
    return times.empty() ? count : fmt::format("{}, t = {} to {}", count, time_text(times.front()), time_text(times.back()));
}

std::string run_text(const std::string& path) {
    const engine::RunReader run(path);
    const std::vector<engine::Attribute>& all = run.attributes();
    const auto of = [&](std::string_view name) { return text_of(all, name); };
    const bool running = run.status() == "running";
    std::string text =
        fmt::format("{}: record of a run, {}\n", engine::visible(path), size_text(static_cast<double>(std::filesystem::file_size(path))));
    text += field("status", running ? "running (still being written, or left by a killed run)" : run.status());
    text += field("seal", run.sealed() ? "intact: every byte is as the run wrote it" : "none: numbers cannot be verified");
    text += field("scene", of("scene"));
    if (const auto scene = scene_in(all, "parameters")) text += field("detail", detail_text(*scene));
    text += field("method", fmt::format("{}, step {}, seed {}", of("method"), step_text(all), of("seed")));
    text += field("program", fmt::format("cvtflow {} ({}), {} {}, {}, HDF5 {}", of("program_version"), of("commit"), of("compiler"),
                                         of("build_type"), of("instruction_set"), of("hdf5_version")));
    text += field("machine", fmt::format("{}, {} cores, {}", of("cpu"), of("cores"), of("os")));
    text += field("date", of("date"));
    if (!running) text += field("wall time", of("wall_seconds") + " s") + field("state hash", of("state_hash"));
    text += field("rows", span_text(run.times()));
    text += field("states", span_text(run.state_times()));
    return text + channels_text(run) + tables_text(run);
}

std::string state_text(const std::string& path) {
    const engine::SavedState saved = engine::read_state(path);
    const std::string hash =
        engine::Hash().add(std::span<const double>(saved.state)).add(std::span<const std::uint8_t>(saved.phases)).hex();
    const auto touching = std::count_if(saved.phases.begin(), saved.phases.end(), [](std::uint8_t phase) { return phase != 0; });
    std::string text =
        fmt::format("{}: state, {}\n", engine::visible(path), size_text(static_cast<double>(std::filesystem::file_size(path))));
    text += field("time", time_text(saved.time));
    text += field("unknowns", count_text(static_cast<long>(saved.state.size())));
    text += field("tips", fmt::format("{}, {} of them not free", saved.phases.size(), touching));
    text += field("state hash", hash);
    text += field("fingerprint", saved.fingerprint);
    const auto scene = scene_in(saved.attributes, "scene");
    if (!scene) return text + field("settled with", "a scene that this program cannot read");
    text += field("settled with", fmt::format("scene {}, {} pins", scene->name, scene->parameters.chain.pins));
    text += field("", detail_text(*scene));
    const std::string method = text_of(saved.attributes, "method", tasks::method_of(*scene));
    text += field("", fmt::format("{} with step {}, {} of settling", method, step_text(saved.attributes, scene->run.step.value_or(0.0)),
                                  time_text(scene->parameters.start.settling_time)));
    return text;
}

std::string columns_text(const engine::RowLayout& layout) {
    Table columns({{"column"}, {"unit"}, {"meaning"}});
    for (const engine::TableColumn& column : layout.columns()) columns.add({column.name, column.unit, column.description});
    return "\n" + columns.text(2);
}

/// @param file a sweep's table
std::string sweep_text(const std::string& file) {
    const bool running = engine::being_written((std::filesystem::path(file).parent_path() / "lock").string());
    const engine::CaseTable table = tasks::read_results(file);
    const auto of = [&](const char* name) { return engine::visible(table.attribute(name)); };
    tasks::CaseTally tally;
    for (std::size_t row = 0; row < table.size(); ++row) tally.add(table.layout, table.row(row));
    std::string text = fmt::format("{}: results of a sweep, {}\n", engine::visible(file),
                                   size_text(static_cast<double>(std::filesystem::file_size(file))));
    text += field("sweep", of("sweep")) + (of("description").empty() ? "" : field("", of("description"))) +
            field("status", of("status") == "running" && !running ? "not finished, or running elsewhere" : of("status"));
    text += field("cases", fmt::format("{} of {}", table.size(), of("cases"))) + tally_text(tally);
    text += field("program", fmt::format("cvtflow {} ({})", of("program_version"), of("commit"))) + field("date", of("date"));
    text += field("results hash", tasks::results_hash(table)) + field("rows", "cvtflow table " + file);
    return text + columns_text(table.layout);
}

/// @throws engine::RecordError also for a folder without a table, with what it contains
tasks::FolderProgress folder_progress(const std::string& folder) {
    tasks::FolderProgress progress = tasks::folder_progress(folder);
    if (progress.parts.empty()) static_cast<void>(table_path(folder));
    return progress;
}

/// State of a part. Cases that a killed process had claimed are done by others.
std::string part_state(const tasks::FolderProgress::Part& part) {
    return part.running ? "running" : part.claimed > part.done ? "stopped" : "ended";
}

/// Progress of the processes that share a folder.
std::string shared_text(const std::string& folder, tasks::FolderProgress progress) {
    constexpr std::size_t shown_parts = 20;
    const auto of = [&](const char* name) { return engine::visible(progress.head.attribute(name)); };
    std::string text = fmt::format("{}: a sweep in parts, {} of {} running\n", folder, progress.running(), progress.parts.size());
    text += field("sweep", of("sweep")) + (of("description").empty() ? "" : field("", of("description")));
    text += field("cases", fmt::format("{} of {}", progress.tally.rows(), progress.cases)) + tally_text(progress.tally);
    Table table({{"folder"}, {"cases claimed", Align::right}, {"done", Align::right}, {"process"}});
    std::stable_partition(progress.parts.begin(), progress.parts.end(),
                          [](const tasks::FolderProgress::Part& part) { return part.running; });
    for (std::size_t k = 0; k < std::min(shown_parts, progress.parts.size()); ++k) {
        const tasks::FolderProgress::Part& part = progress.parts[k];
        table.add({part.folder, std::to_string(part.claimed), std::to_string(part.done), part_state(part)});
    }
    const std::size_t more = progress.parts.size() - std::min(shown_parts, progress.parts.size());
    return text + "\n" + table.text(2) + (more > 0 ? fmt::format("  … and {} more\n", more) : "");
}

nlohmann::ordered_json sweep_json(const std::string& folder) {
    const tasks::FolderProgress progress = folder_progress(folder);
    nlohmann::ordered_json parts = nlohmann::ordered_json::array();
    for (const tasks::FolderProgress::Part& part : progress.parts)
        parts.push_back({{"folder", part.folder}, {"claimed", part.claimed}, {"done", part.done}, {"process", part_state(part)}});
    nlohmann::ordered_json all{
        {"folder", folder}, {"sweep", progress.head.attribute("sweep")}, {"cases", progress.cases}, {"done", progress.tally.rows()}};
    all.update(tally_json(progress.tally));
    all["running"] = progress.running();
    all["parts"] = parts;
    return all;
}

/// Text for the kind of the file.
std::string info_text(const std::string& path) {
    if (std::filesystem::is_directory(path)) {
        const bool whole = std::filesystem::exists(std::filesystem::path(path) / "cases.h5");
        return whole ? sweep_text(table_path(path)) : shared_text(path, folder_progress(path));
    }
    constexpr std::string (*kinds[])(const std::string&) = {run_text, state_text, sweep_text};
    for (const auto kind : kinds) {
        try {
            return kind(path);
        } catch (const engine::RecordError& error) {
            const bool other_kind = std::string_view(error.what()).find("an HDF5 file, but not a ") != std::string_view::npos;
            if (!other_kind) throw;
        }
    }
    throw engine::RecordError(path + ": an HDF5 file, but neither a record, a state nor a sweep's table of cvtflow");
}

}  // namespace

Action declare_info(CLI::App& app) {
    const auto path = std::make_shared<std::string>();
    with_default_place(
        app.add_option("FILE", *path, "Record (also FILE.part of a running or killed run), state file, or a sweep's folder or cases.h5"))
        ->required()
        ->type_name("");
    const auto json = std::make_shared<bool>(false);
    app.add_flag("--json", *json, "A sweep's folder: how far it is, as JSON");
    return [path, json] {
        if (*json && !std::filesystem::is_directory(*path)) throw UsageError("--json requires the folder of a sweep");
        fmt::print("{}", *json ? sweep_json(*path).dump(2) + "\n" : info_text(*path));
        return ExitStatus::finished;
    };
}

}  // namespace cvtflow::tools
