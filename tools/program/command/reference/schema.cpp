#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "tasks/batch/sweep/sweep_keys.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tools/program/command/command.hpp"

namespace cvtflow::tools {

Action declare_schema(CLI::App& app) {
    const auto sweep = std::make_shared<bool>(false);
    app.add_flag("--sweep", *sweep, "The schema of sweeps instead of scenes");
    return [sweep] {
        fmt::print("{}", *sweep ? tasks::sweep_schema() : tasks::json_schema());
        return ExitStatus::finished;
    };
}

}  // namespace cvtflow::tools
