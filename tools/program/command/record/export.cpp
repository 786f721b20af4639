#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <numeric>

#include "engine/record/run/run_reader.hpp"
#include "tasks/scene/csv.hpp"
#include "tasks/scene/scene.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/program.hpp"
#include "tools/program/text/report_columns.hpp"
#include "tools/program/view/recorded_run.hpp"
#include "tools/program/view/vtk_series.hpp"

namespace cvtflow::tools {

namespace {

struct ExportArguments {
    std::string record, vtk, csv;
    std::vector<std::string> channels;
    int every = 1;
    bool force = false;
};

/// The scene that a record was made from. @throws engine::RecordError
tasks::Scene recorded_scene(const std::string& path, const engine::RunReader& run) {
    const auto* text = engine::attribute_value<std::string>(run.attributes(), "parameters");
    if (text == nullptr) throw engine::RecordError(path + ": contains no parameters of a machine");
    try {
        return tasks::parse_scene(*text, "scene", tasks::StartState::recorded);
    } catch (const tasks::SceneError& error) {
        throw engine::RecordError(fmt::format("{}: cannot read the parameters of its machine: {}", path, error.what()));
    }
}

/// The requested channels, one column per number; without a request all channels of one number.
std::vector<Curve> columns_of(const RecordedRun& run, const std::vector<std::string>& words) {
    std::vector<Curve> columns;
    for (const std::string& word : words) {
        for (Curve& curve : run.find(word)) columns.push_back(std::move(curve));
    }
    for (const engine::ChannelInfo& channel : run.reader().channels()) {
        if (words.empty() && channel.width == 1) columns.push_back(run.curves(channel).front());
    }
    return columns;
}

/// A row per output, a column per number, units in the heading.
std::string csv_of(const std::vector<double>& times, const std::vector<Curve>& curves) {
    std::vector<ReportColumn<std::size_t>> columns;
    const auto add = [&](const std::string& name, const std::vector<double>& values) {
        columns.push_back({csv_cell(name), "", [&values](std::size_t row) { return values[row]; }, {}, Align::right, all_digits});
    };
    add("time [s]", times);
    for (const Curve& curve : curves) add(fmt::format("{} [{}]", curve.name, curve.unit.empty() ? "1" : curve.unit), curve.values);
    std::vector<std::size_t> rows(times.size());
    std::iota(rows.begin(), rows.end(), std::size_t{0});
    return report_csv(columns, rows);
}

ExitStatus export_csv(const ExportArguments& arguments) {
    const RecordedRun run(arguments.record);
    const std::vector<Curve> columns = columns_of(run, arguments.channels);
    const engine::Permit permit(arguments.csv, {.inputs = {arguments.record}, .force = arguments.force, .named = true, .devices = true});
    engine::write_whole(permit, csv_of(run.times(), columns));
    say(false, permit.notice());
    fmt::print("{}", field("written", fmt::format("{}, {} of {}", arguments.csv, plural(static_cast<long>(run.times().size()), "row"),
                                                  plural(static_cast<long>(columns.size() + 1), "column"))));
    return ExitStatus::finished;
}

ExitStatus export_record(const ExportArguments& arguments) {
    if (arguments.vtk.empty() == arguments.csv.empty()) throw UsageError("exactly one of --csv FILE and --vtk FILE.pvd is required");
    if (!arguments.csv.empty()) return export_csv(arguments);
    if (!arguments.channels.empty()) throw UsageError("channels require --csv");
    if (std::filesystem::path(arguments.vtk).extension() != ".pvd")
        throw UsageError(fmt::format("--vtk {}: the name must end in .pvd", arguments.vtk));
    const engine::RunReader run(arguments.record);
    const engine::Permit permit(arguments.vtk, {.inputs = {arguments.record}, .force = arguments.force, .named = true});
    const tasks::Scene scene = recorded_scene(arguments.record, run);
    const model::Variator variator(scene.parameters);
    const std::size_t states = run.state_times().size();
    if (states == 0) throw engine::RecordError(arguments.record + ": contains no states");
    ChainSolids solids(variator, scene.parameters);
    VtkSeries series(permit, solids.mesh(), ChainSolids::arrays(), arguments.force);
    VtkFrame frame;
    long shown = 0;
    for (std::size_t number = 0; number < states; number += static_cast<std::size_t>(arguments.every), ++shown) {
        const engine::RecordedState recorded = machine_state(arguments.record, run, number, variator.layout());
        if (!finite(recorded)) throw engine::RecordError(fmt::format("{}: state {} is not finite", arguments.record, number));
        solids.show(recorded.time, recorded.state.data(), reinterpret_cast<const model::Phase*>(recorded.phases.data()), frame);
        series.add(recorded.time, frame);
    }
    const std::uintmax_t bytes = series.finish();
    say(false, permit.notice());
    fmt::print("{}", field("written", fmt::format("{}, {} of {} cells, {}", arguments.vtk, plural(shown, "state"), solids.mesh().cells(),
                                                  size_text(static_cast<double>(bytes)))));
    return ExitStatus::finished;
}

}  // namespace

Action declare_export(CLI::App& app) {
    const auto arguments = std::make_shared<ExportArguments>();
    with_default_place(app.add_option("RECORD", arguments->record, "Record of a run; ParaView shows its states (run.state_interval)"))
        ->required()
        ->type_name("");
    app.add_option("CHANNEL", arguments->channels, "With --csv: channels, groups or elements (default: all channels of one number)")
        ->type_name("...");
    app.add_option("--csv", arguments->csv, "Table to write: one row per output, one column per number, units in the heading")
        ->type_name("FILE");
    app.add_option("--vtk", arguments->vtk,
                   "Collection to write for ParaView; its states go to the folder FILE: pins, plates and sheaves with forces")
        ->type_name("FILE.pvd");
    app.add_option("--every", arguments->every, "Write every COUNT-th state only")->check(CLI::Range(1, 1000000))->type_name("COUNT");
    app.add_flag("--force", arguments->force, force_meaning);
    return [arguments] { return export_record(*arguments); };
}

}  // namespace cvtflow::tools
