#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <memory>

#include "engine/base/hash.hpp"
#include "engine/base/text.hpp"
#include "engine/record/run/run_reader.hpp"
#include "engine/record/run/state_file.hpp"
#include "tasks/batch/batch.hpp"
#include "tools/program/command/sweep/batch.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/program.hpp"
#include "tools/program/text/scene_text.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

std::string last_text(const std::vector<double>& last) {
    std::vector<double> finite;
    std::ranges::copy_if(last, std::back_inserter(finite), [](double number) { return std::isfinite(number); });
    if (finite.empty()) return last.empty() ? "" : "undefined";
    const auto [least, largest] = std::ranges::minmax(finite);
    return last.size() == 1 ? fmt::format("{:.6g}", least) : fmt::format("{:.6g} ... {:.6g}", least, largest);
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
    if (const auto scene = scene_in(engine::attribute_value<std::string>(all, "parameters"))) text += field("detail", detail_text(*scene));
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
    const auto scene = scene_in(&saved.scene);
    if (!scene) return text + field("settled with", "a scene that this program cannot read");
    text += field("settled with", fmt::format("scene {}, {} pins", scene->name, scene->parameters.chain.pins));
    text += field("", detail_text(*scene));
    text += field("", fmt::format("{} with step {}, {} of settling", saved.method.empty() ? tasks::method_of(*scene) : saved.method,
                                  step_text(saved.step, scene->run.step.value_or(0.0)), time_text(scene->parameters.start.settling_time)));
    return text;
}

/// The folder itself. @throws engine::RecordError for one without results, with the records in it
const std::string& sweep_folder(const std::string& folder) {
    constexpr std::size_t shown = 3;
    if (tasks::holds_sweep(folder)) return folder;
    std::error_code unreadable;
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder, unreadable))
        if (entry.path().extension() == ".h5") files.push_back(entry.path().string());
    std::sort(files.begin(), files.end());
    const std::size_t count = files.size();
    files.resize(std::min(count, shown));
    throw engine::RecordError(fmt::format(
        "{}: a folder without results of a sweep (sweep.json){}", folder,
        count == 0 ? "" : fmt::format("; it contains {}{}: name one of these files", fmt::join(files, ", "), count > shown ? ", …" : "")));
}

std::string columns_text(const std::vector<tasks::ResultColumn>& all) {
    Table columns({{"column"}, {"unit"}, {"meaning"}});
    for (const auto& [name, unit, description, key] : all) columns.add({name, unit, description});
    return "\n" + columns.text(2);
}

long running(const tasks::FolderProgress& progress) {
    return std::ranges::count(progress.workers, true, &tasks::FolderProgress::Worker::running);
}

/// Processes that have added rows, running ones first.
std::string workers_text(std::vector<tasks::FolderProgress::Worker> workers) {
    constexpr std::size_t shown = 20;
    std::stable_partition(workers.begin(), workers.end(), [](const auto& worker) { return worker.running; });
    Table table({{"rows of"}, {"claims", Align::right}, {"cases", Align::right}, {"process"}});
    for (std::size_t k = 0; k < std::min(shown, workers.size()); ++k)
        table.add({workers[k].name, std::to_string(workers[k].pieces), std::to_string(workers[k].rows),
                   workers[k].running ? "running" : "ended, or on another machine"});
    const std::size_t more = workers.size() - std::min(shown, workers.size());
    return "\n" + table.text(2) + (more > 0 ? fmt::format("  … and {} more\n", more) : "");
}

std::string sweep_text(const std::string& folder) {
    const tasks::FolderProgress progress = tasks::folder_progress(folder);
    const auto of = [&](const char* name) { return engine::visible(progress.facts.text(name)); };
    const bool finished = progress.facts.finished();
    std::string text = fmt::format("{}: results of a sweep\n", engine::visible(folder));
    text += field("sweep", of("sweep")) + (of("description").empty() ? "" : field("", of("description"))) +
            field("status", finished                ? "finished"
                            : running(progress) > 0 ? "running"
                                                    : "not finished, or running elsewhere");
    text += field("cases", fmt::format("{} of {}", progress.tally.rows(), of("cases"))) + tally_text(progress.tally);
    text += field("program", fmt::format("cvtflow {} ({})", of("program_version"), of("commit"))) + field("date", of("date"));
    if (finished) text += field("results hash", of("results_hash"));
    text += field("rows", "cvtflow table " + folder);
    return text + (finished ? "" : workers_text(progress.workers)) + columns_text(progress.facts.columns);
}

nlohmann::ordered_json sweep_json(const std::string& folder) {
    const tasks::FolderProgress progress = tasks::folder_progress(folder);
    nlohmann::ordered_json workers = nlohmann::ordered_json::array();
    for (const auto& [name, rows, pieces, at_work] : progress.workers)
        workers.push_back({{"rows", name}, {"claims", pieces}, {"cases", rows}, {"running", at_work}});
    nlohmann::ordered_json all{{"folder", folder},
                               {"sweep", progress.facts.text("sweep")},
                               {"status", progress.facts.text("status")},
                               {"cases", progress.facts.cases()},
                               {"done", progress.tally.rows()}};
    all.update(tally_json(progress.tally));
    all["running"] = running(progress);
    all["workers"] = workers;
    return all;
}

/// Text for the kind of the file.
std::string info_text(const std::string& path) {
    if (std::filesystem::is_directory(path)) return sweep_text(sweep_folder(path));
    return engine::head_of(path).starts_with(engine::state_mark) ? state_text(path) : run_text(path);
}

}  // namespace

Action declare_info(CLI::App& app) {
    const auto path = std::make_shared<std::string>();
    with_default_place(app.add_option("FILE", *path, "Record (also FILE.part of a running or killed run), state file, or a sweep's folder"))
        ->required()
        ->type_name("");
    const auto json = std::make_shared<bool>(false);
    app.add_flag("--json", *json, "A sweep's folder: how far it is, as JSON");
    return [path, json] {
        if (*json && !std::filesystem::is_directory(*path)) throw UsageError("--json requires the folder of a sweep");
        fmt::print("{}", *json ? sweep_json(sweep_folder(*path)).dump(2) + "\n" : info_text(*path));
        return ExitStatus::finished;
    };
}

}  // namespace cvtflow::tools
