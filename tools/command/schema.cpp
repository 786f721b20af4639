#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "tasks/scene/parameter_table.hpp"
#include "tools/command.hpp"

namespace cvtflow::tools {

Action declare_schema(CLI::App&) {
    return [] {
        fmt::print("{}", tasks::json_schema());
        return ExitStatus::finished;
    };
}

}  // namespace cvtflow::tools
