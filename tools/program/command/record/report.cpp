#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "engine/base/text.hpp"
#include "tasks/run/run_means.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tools/program/drawing.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/program.hpp"
#include "tools/program/text/scene_text.hpp"
#include "tools/program/text/text.hpp"
#include "tools/program/view/described.hpp"

namespace cvtflow::tools {

namespace {

using Json = nlohmann::json;

struct ReportArguments {
    std::vector<std::string> files;
    std::string output, with;
    bool si = false, force = false;
};

/// The page shows what was recorded; the chain needs the machine as well.
void warn_without_machine(const RecordedRun& run, const std::string& file) {
    const auto* text = engine::attribute_value<std::string>(run.reader().attributes(), "parameters");
    if (text == nullptr || run.scene()) return;
    try {
        static_cast<void>(tasks::parse_scene(*text, "scene", tasks::StartState::recorded));
    } catch (const tasks::SceneError& error) {
        to_stderr(fmt::format("{}: {}: the page shows no chain: cannot read the parameters of its machine: {}\n", program_name(), file,
                              error.what()));
    }
}

/// Default and meaning of every key, meanings of notes.
void add_meanings(Json& request) {
    const tasks::Scene usual;
    for (const tasks::Parameter& key : tasks::parameter_table())
        request["keys"][std::string(key.key)] = {tasks::readable_value(key, usual), key.meaning};
    for (const tasks::NoteKind& kind : tasks::note_kinds) request["notes"][std::string(kind.name)] = kind.meaning;
}

void add_record(Json& request, const std::string& file) {
    const RecordedRun run(file);
    warn_without_machine(run, file);
    Json record = described(run);
    record["detail"] = run.scene() ? detail_text(*run.scene()) : "";
    request["records"].push_back(std::move(record));
}

void add_sweep(Json& request, const std::string& file) {
    const SweepView view = read_sweep(file);
    Json sweep = described(view);
    sweep["detail"] = view.scene ? detail_text(*view.scene) : "";
    sweep["attributes"] = sweep["texts"] = Json::object();
    for (const engine::Attribute& each : view.attributes)
        std::visit([&](const auto& value) { sweep["attributes"][each.name] = value; }, each.value);
    if (view.scene)
        for (const tasks::Parameter& key : tasks::parameter_table())
            sweep["texts"][std::string(key.key)] = tasks::readable_value(key, *view.scene);
    request["sweeps"].push_back(std::move(sweep));
}

/// The request for a page.
Json request_of(const ReportArguments& arguments) {
    Json request{{"command", "report"}, {"known", known_json()}, {"options", {{"si", arguments.si}}}};
    add_meanings(request);
    const auto sweeps = std::ranges::count_if(arguments.files, is_sweep);
    if (sweeps != 0 && sweeps != std::ssize(arguments.files)) throw UsageError("a report covers records, or sweeps");
    for (const std::string& file : arguments.files) sweeps != 0 ? add_sweep(request, file) : add_record(request, file);
    if (!arguments.with.empty()) request["with"] = described(read_measured(arguments.with));
    return request;
}

ExitStatus report(const ReportArguments& arguments) {
    const std::string path = picture_path(arguments.output, arguments.files.front(), "report.html");
    std::vector<std::string> files = arguments.files;
    if (!arguments.with.empty()) files.push_back(arguments.with);
    const std::vector<std::filesystem::path> inputs = read_files(files);
    engine::require_no_input(path, inputs);
    const Json request = request_of(arguments);
    const std::string of = subject_of(request);
    const engine::Permit permit(path, marked_rule("page", of, inputs, arguments.force));
    const std::string page = marked(drawn(request), mark_of("page", of));
    engine::write_whole(permit, page);
    fmt::print("{} ({})\n", engine::visible(path), size_text(static_cast<double>(page.size())));
    return ExitStatus::finished;
}

}  // namespace

Action declare_report(CLI::App& app) {
    const auto arguments = std::make_shared<ReportArguments>();
    with_default_place(
        app.add_option("FILE", arguments->files, "Records, or sweeps (folder, cases.h5, or CSV); several are shown beside each other"))
        ->required()
        ->type_name("...");
    app.add_option("-o,--output", arguments->output, "Page to write (default: beside the input, .html)")->type_name("FILE");
    app.add_option("--with", arguments->with, "Measured data beside the results: a CSV as plot --with takes it")->type_name("FILE");
    app.add_flag("--si", arguments->si, si_meaning);
    app.add_flag("--force", arguments->force, force_meaning);
    app.footer(
        "The page is one file and needs no network: status and warnings, key figures and differences, vehicle, scene, curves, running\n"
        "chain, pin forces, losses, wear, spectra, provenance. Python draws (python3-matplotlib, python3-h5py, python3-jinja2). A page of "
        "the same scene or sweep is replaced, any other file only with "
        "--force. Long records are thinned "
        "to minima and maxima, and the page states it.");
    return [arguments] { return report(*arguments); };
}

}  // namespace cvtflow::tools
