#include "tools/program/arguments/tuning_arguments.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <sstream>

#include "tasks/scene/units.hpp"
#include "tools/program/arguments/scene_arguments.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::tools {

namespace {

/// "a, b" as {"a", "b"}.
std::vector<std::string> names_of(const std::string& list) {
    std::vector<std::string> names;
    std::istringstream rest(list);
    for (std::string name; std::getline(rest, name, ',');) {
        const auto first = name.find_first_not_of(' ');
        if (first != std::string::npos) names.push_back(name.substr(first, name.find_last_not_of(' ') - first + 1));
    }
    return names;
}

}  // namespace

void declare_tuning(CLI::App& app, TuningArguments& arguments) {
    std::vector<std::string> names;
    for (const tasks::Figure& figure : tasks::figures()) names.emplace_back(figure.name);
    app.add_option("--accuracy", arguments.accuracy, "Target: largest error of the outputs, e.g. \"1 %\"")->type_name("SHARE");
    app.add_option("--outputs", arguments.outputs,
                   fmt::format("Outputs whose error counts, separated by commas: {}, or as in a sweep, \"slip median\" (default: slip, "
                               "efficiency, tight_tension, tips)",
                               fmt::join(names, ", ")))
        ->type_name("LIST");
    app.add_option("--methods", arguments.methods,
                   "Methods to choose from, separated by commas (default: the default method and the cheapest of the catalogue)")
        ->type_name("LIST");
    app.add_option("--budget", arguments.budget, "Wall time of the search, references included, e.g. \"2 min\"")->type_name("TIME");
    const tasks::PointTimes usual;
    app.add_option("--settling", arguments.settle,
                   fmt::format("Simulated time before the averages begin (default: {:g} ms)", 1e3 * usual.settle))
        ->type_name("TIME");
    app.add_option("--average", arguments.average,
                   fmt::format("Simulated time that the averages cover (default: {:g} ms)", 1e3 * usual.average))
        ->type_name("TIME");
}

tasks::TuneSettings tune_settings(const TuningArguments& arguments, bool quiet) {
    tasks::TuneSettings settings;
    if (arguments.accuracy) {
        const auto accuracy = tasks::read_accuracy(*arguments.accuracy);
        if (!accuracy)
            throw UsageError(fmt::format("--accuracy {}: expected a share above 0 and up to 50 %, such as \"1 %\"", *arguments.accuracy));
        settings.accuracy = *accuracy;
    }
    settings.outputs = names_of(arguments.outputs);
    settings.methods = names_of(arguments.methods);
    for (const std::string& method : settings.methods) require_method(method);
    if (arguments.budget) settings.budget = seconds_of("--budget", *arguments.budget);
    if (arguments.settle) settings.times.settle = seconds_of("--settling", *arguments.settle);
    if (arguments.average) settings.times.average = seconds_of("--average", *arguments.average);
    if (!quiet) settings.progress = [](const std::string& what) { print_error(what); };
    return settings;
}

}  // namespace cvtflow::tools
