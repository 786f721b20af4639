#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "engine/record/run/run_reader.hpp"
#include "tasks/scene/scene.hpp"
#include "tools/program/command/command.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output/output_place.hpp"
#include "tools/program/output/replacing.hpp"
#include "tools/program/report/chain_solids.hpp"
#include "tools/program/text/text.hpp"
#include "tools/program/view/machine_state.hpp"

namespace cvtflow::tools {

namespace {

struct ExportArguments {
    std::string record, vtk;
    int every = 1;
    bool force = false;
};

/// The scene that a record was made from. @throws engine::RecordError
tasks::Scene recorded_scene(const std::string& path, const engine::RunReader& run) {
    const auto parameters = run.attribute("parameters");
    const auto* text = parameters ? std::get_if<std::string>(&parameters->value) : nullptr;
    if (text == nullptr) throw engine::RecordError(path + ": it does not say which machine it is of");
    try {
        return tasks::parse_scene(*text, "scene", tasks::StartState::ignored);
    } catch (const tasks::SceneError& error) {
        throw engine::RecordError(fmt::format("{}: its machine cannot be read: {}", path, error.what()));
    }
}

ExitStatus export_record(const ExportArguments& arguments) {
    if (arguments.vtk.empty()) throw UsageError("--vtk FILE.pvd is required: what should be written?");
    if (std::filesystem::path(arguments.vtk).extension() != ".pvd")
        throw UsageError(fmt::format("--vtk {}: the name has to end in .pvd", arguments.vtk));
    const engine::RunReader run(arguments.record);
    const std::string replaced = replacing(arguments.vtk, true, arguments.force);
    require_output(arguments.vtk, {arguments.record});
    const tasks::Scene scene = recorded_scene(arguments.record, run);
    const model::Variator variator(scene.parameters);
    const std::size_t states = run.state_times().size();
    if (states == 0) throw engine::RecordError(arguments.record + ": it has no states");
    ChainSolids solids(variator, scene.parameters);
    VtkSeries series(arguments.vtk, solids.mesh(), ChainSolids::arrays(), arguments.force);
    VtkFrame frame;
    long shown = 0;
    for (std::size_t number = 0; number < states; number += static_cast<std::size_t>(arguments.every), ++shown) {
        const engine::RecordedState recorded = machine_state(arguments.record, run, number, variator.layout());
        if (!finite(recorded)) throw engine::RecordError(fmt::format("{}: state {} is not finite", arguments.record, number));
        solids.show(recorded.time, recorded.state.data(), reinterpret_cast<const model::Phase*>(recorded.phases.data()), frame);
        series.add(recorded.time, frame);
    }
    const std::uintmax_t bytes = series.finish();
    if (!replaced.empty()) print_error(replaced);
    fmt::print("{}", field("written", fmt::format("{}, {} of {} cells, {}", arguments.vtk, plural(shown, "state"), solids.mesh().cells(),
                                                  size_text(static_cast<double>(bytes)))));
    return ExitStatus::finished;
}

}  // namespace

Action declare_export(CLI::App& app) {
    const auto arguments = std::make_shared<ExportArguments>();
    app.add_option("RECORD", arguments->record, "Record of a run; its states are shown (run.state_interval)")->required()->type_name("");
    app.add_option("--vtk", arguments->vtk,
                   "Collection to write for ParaView, FILE.pvd; its states go to the folder FILE: pins, plates and sheaves with forces")
        ->type_name("FILE.pvd");
    app.add_option("--every", arguments->every, "Only every so many states")->check(CLI::Range(1, 1000000))->type_name("COUNT");
    app.add_flag("--force", arguments->force, force_meaning);
    return [arguments] { return export_record(*arguments); };
}

}  // namespace cvtflow::tools
