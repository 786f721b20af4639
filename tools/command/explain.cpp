#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "tasks/batch/sweep/sweep_keys.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tools/command.hpp"

namespace cvtflow::tools {

namespace {

/// A section stands for all its keys.
std::vector<std::string> keys_of(const std::string& word) {
    std::vector<std::string> keys;
    for (const tasks::Parameter& parameter : tasks::parameter_table()) {
        if (parameter.section() == word) keys.emplace_back(parameter.key);
    }
    return keys.empty() ? std::vector{word} : keys;
}

ExitStatus explain(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) {
        if (tasks::names_sweep(word)) {
            text += (text.empty() ? "" : "\n") + tasks::explain_sweep(word);
            continue;
        }
        for (const std::string& key : keys_of(word)) text += (text.empty() ? "" : "\n") + tasks::explain(key);
    }
    fmt::print("{}", text);
    return ExitStatus::finished;
}

}  // namespace

Action declare_explain(CLI::App& app) {
    const auto keys = std::make_shared<std::vector<std::string>>();
    app.add_option("KEY", *keys,
                   "Key such as tip.radius, or a section such as tip for all its keys; of sweep files sweep.axes.key, sweep.axes, sweep")
        ->required()
        ->type_name("");
    return [keys] { return explain(*keys); };
}

}  // namespace cvtflow::tools
