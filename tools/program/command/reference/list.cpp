#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>
#include <set>
#include <utility>

#include "engine/base/text.hpp"
#include "engine/method/catalogue.hpp"
#include "engine/thread/worker_threads.hpp"
#include "tasks/batch/sweep/sweep.hpp"
#include "tasks/channel/channels.hpp"
#include "tasks/method/method.hpp"
#include "tasks/run/run_means.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tasks/scene/units.hpp"
#include "tools/program/command/reference/terms.hpp"
#include "tools/program/embedded.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/program.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

/// The recommended methods, and what each is for.
constexpr std::pair<const char*, const char*> choices[] = {
    {"leapfrog-sweep", "one evaluation of all forces a step, friction solved for contact by contact; pin halves, every friction law"},
    {"leapfrog-rigid", "one evaluation of all forces a step, friction solved for where it acts; rigid pins, every friction law"},
    {"dumka3", "explicit, stages by the spectrum, steps also by local error (run.step_control = \"error\"); every friction law"},
    {"dumka3-p5", "explicit, fixed steps, 2 us at full detail: friction is not split off; a sixth of the cost of rk4"},
    {"rk4", "the reference: order 4, 45 ns or less at full detail"},
};

std::string methods() {
    Table table({{"method"}, {"used for"}});
    table.add({std::string(tasks::automatic_method), "the default: a method by detail and friction law, as listed below"});
    for (const auto& [method, reason] : choices) table.add({method, reason});
    std::string automatic;
    for (const tasks::AutomaticChoice& row : tasks::automatic_choices()) automatic += fmt::format("\n  {}: {}", row.method, row.machines);
    return table.text() + "\nauto is the first of these that suits:" + automatic + "\n" +
           "\nAll methods, with stages and order: cvtflow list methods --all.\n";
}

/// "5", or "5(4)" with an embedded solution.
std::string order_text(const engine::StagePlan& plan) {
    return plan.embedded_order > 0 ? fmt::format("{}({})", plan.order, plan.embedded_order) : fmt::format("{}", plan.order);
}

std::string all_methods() {
    Table table({{"method"}, {"stages", Align::right}, {"order", Align::right}, {"description"}});
    for (const engine::StagePlan& plan : engine::methods()) {
        table.add({plan.name, fmt::format("{}", plan.stages.size()), order_text(plan), plan.description});
    }
    for (const tasks::MethodProgram& program : tasks::method_programs()) {
        table.add({program.name, program.evaluations > 0 ? fmt::format("{}", program.evaluations) : "", fmt::format("{}", program.order),
                   program.description});
    }
    std::string families;
    for (const engine::MethodFamily& family : engine::method_families())
        families += fmt::format("\n  {}\n    {}: {}", family.form, family.description, family.limits);
    return table.text() + (families.empty() ? "" : "\nFamilies; any member may be named:" + families + "\n") +
           "\norder p(q): the embedded solution has order q. cvtflow-lab list methods --all has all methods of the laboratory, too; "
           "cvtflow-lab method NAME prints a method's table, stability and growth of errors.\n";
}

std::string detail() {
    Table table({{"detail"},
                 {"pins"},
                 {"plates"},
                 {"joint points", Align::right},
                 {"cost", Align::right},
                 {"tensions", Align::right},
                 {"slip", Align::right},
                 {"meaning"}});
    for (const tasks::DetailPreset& preset : tasks::detail_presets()) {
        table.add({std::string(preset.name), std::string(name_of(preset.pins)),
                   preset.plates == model::PlateDetail::each ? "each" : "lumped", fmt::format("{}", preset.joint_points),
                   fmt::format("{:.2g}", preset.cost), fmt::format("{:.2g} %", 100.0 * preset.tension_error),
                   fmt::format("{:.2g} %", 100.0 * preset.slip_error), std::string(preset.meaning)});
    }
    return table.text() +
           "\ncost: processor time per simulated second, relative to \"fine\"; default method, automatic step.\n"
           "tensions, slip: median error at seven operating points, relative to the finest level at a quarter of its step.\n"
           "Slip of \"rigid\" is off by 5.9 % at most.\n"
           "A scene names a level by detail.level, a command by --detail.\n"
           "cvtflow tune SCENE chooses the level, with --all it measures every level at your scene.\n";
}

std::string channels() {
    Table table({{"channel"}, {"unit"}, {"per"}, {"description"}});
    for (const tasks::Channel& channel : tasks::channels())
        table.add({std::string(channel.name), std::string(channel.unit), std::string(channel.axis), std::string(channel.description)});
    return table.text();
}

std::string scenes() {
    Table table({{"scene"}, {"pins", Align::right}, {"description"}});
    std::set<std::string> folders;
    for (const tasks::ReadyScene& ready : tasks::ready_scenes()) {
        folders.insert(ready.path.parent_path().string());
        try {
            const tasks::Scene scene = tasks::read_scene(ready.path, tasks::StartState::ignored);
            table.add({ready.name, fmt::format("{}", scene.parameters.chain.pins), scene.description});
        } catch (const tasks::SceneError&) {
            table.add({ready.name, "", "(has errors, see cvtflow check)"});
        }
    }
    if (folders.empty())
        return "none: no folder of ready scenes can be read; set the environment variable CVTFLOW_SCENES to further folders\n";
    return table.text() + fmt::format("\nFrom {}. Further folders: environment variable CVTFLOW_SCENES.\n", fmt::join(folders, ", "));
}

std::string sweeps() {
    Table table({{"sweep"}, {"cases", Align::right}, {"scene"}, {"description"}});
    for (const tasks::ReadyScene& ready : tasks::ready_sweeps()) {
        try {
            const tasks::Sweep sweep = tasks::read_sweep(ready.path.string(), tasks::find_scene);
            table.add({ready.name, fmt::format("{}", sweep.cases()), sweep.scene.name, sweep.description});
        } catch (const std::exception&) {
            table.add({ready.name, "", "", "(has errors, see cvtflow batch --dry-run)"});
        }
    }
    return table.text() + "\nFrom the folders \"sweeps\" beside the ready scenes (cvtflow list scenes). cvtflow batch NAME runs one.\n";
}

std::string notes() {
    Table table({{"note"}, {"meaning"}});
    for (const tasks::NoteKind& kind : tasks::note_kinds) table.add({std::string(kind.name), std::string(kind.meaning)});
    return table.text() +
           "\nA note is a condition under which means of a run are read with care. Summaries of runs, reports, and the column "
           "\"notes\" of sweeps have them.\n";
}

std::string words() {
    Table table({{"word"}, {"meaning"}});
    for (const Term& term : terms) table.add({std::string(term.word), std::string(term.meaning)});
    return table.text();
}

std::string executors() {
    return executor_table() + fmt::format("\nRuntimes: oneTBB {}.\n", engine::tbb_version()) + absent_executor_text();
}

std::string keys() {
    const tasks::Scene defaults;
    Table table({{"key"}, {"default"}, {"SI unit"}, {"meaning"}});
    for (const tasks::Parameter& parameter : tasks::parameter_table()) {
        table.add({std::string(parameter.key), tasks::readable_value(parameter, defaults), std::string(parameter.unit),
                   std::string(parameter.meaning)});
    }
    return table.text();
}

std::string units() {
    Table table({{"quantity"}, {"SI"}, {"also"}, {"example"}});
    std::set<std::string_view> seen{""};
    for (const tasks::Parameter& parameter : tasks::parameter_table()) {
        if (!seen.insert(parameter.unit).second) continue;
        const std::string quantity(tasks::dimension_name(tasks::dimension_of(parameter.unit)));
        table.add({quantity, std::string(parameter.unit), fmt::format("{}", fmt::join(tasks::usual_units(parameter.unit), ", ")),
                   std::string(parameter.key)});
    }
    return table.text() +
           "\nAny product of m cm g s min h rad deg rpm Hz N Pa bar % with prefixes n u m k M G and powers is accepted: \"5.7e4 N/mm\", "
           "\"2.5e10 N/m^1.5\".\nTorques also as Nm, kNm, Nmm; temperatures as degC, °C.\n";
}

std::string licenses() { return std::string(embedded("licenses.txt")); }

struct Listing {
    std::string_view name;
    std::string_view description;
    std::string (*text)();
    std::string (*all)() = nullptr;  ///< text with --all, if that lists more
};

constexpr std::array listings{
    Listing{"methods", "Integration methods: the recommended ones; --all: every method, with stages and order", methods, all_methods},
    Listing{"detail", "Levels of detail, coarsest first", detail},
    Listing{"channels", "Recorded quantities", channels},
    Listing{"scenes", "Ready scenes", scenes},
    Listing{"sweeps", "Ready sweeps", sweeps},
    Listing{"notes", "Notes of runs and of cases of sweeps", notes},
    Listing{"terms", "Words of the field, of scenes and of records", words},
    Listing{"executors", "Executors of the task graph; more for comparison: cvtflow-lab executors", executors},
    Listing{"keys", "All keys of scenes", keys},
    Listing{"units", "Units of quantities", units},
    Listing{"licenses", "Licences of the libraries that this program and its pages contain", licenses},
};

/// The list of that name. @throws UsageError with the closest name
const Listing& listing_of(const std::string& name) {
    const auto* const found = std::ranges::find(listings, name, &Listing::name);
    if (found != listings.end()) return *found;
    std::vector<std::string> names;
    for (const Listing& listing : listings) names.emplace_back(listing.name);
    const std::string near = engine::closest(name, names);
    throw UsageError(near.empty() ? fmt::format("no list '{}', only {}", name, fmt::join(names, ", "))
                                  : fmt::format("no list '{}', did you mean '{}'?", name, near));
}

std::string lists() {
    std::string text = "Lists:";
    for (const Listing& listing : listings) text += fmt::format("\n  {:<12}{}", listing.name, listing.description);
    return text;
}

ExitStatus list(const std::vector<std::string>& names, bool all) {
    std::string text = names.empty() ? lists() + "\n" : "";
    for (const std::string& name : names) {
        const Listing& listing = listing_of(name);
        text += (text.empty() ? "" : "\n") + (all && listing.all != nullptr ? listing.all() : listing.text());
    }
    fmt::print("{}", text);
    return ExitStatus::finished;
}

}  // namespace

Action declare_list(CLI::App& app) {
    const auto names = std::make_shared<std::vector<std::string>>();
    app.add_option("WHAT", *names, "One or more of the names below (default: this list of them)")->type_name("");
    const auto all = std::make_shared<bool>(false);
    app.add_flag("--all", *all, "List every method, not only the recommended ones");
    app.footer(lists());
    return [names, all] { return list(*names, *all); };
}

}  // namespace cvtflow::tools
