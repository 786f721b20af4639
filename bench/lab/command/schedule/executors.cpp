#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "bench/executor/further_executors.hpp"
#include "bench/lab/command/command.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

tools::Action declare_executors(CLI::App&) {
    return [] {
        fmt::print("{}\nRuntimes: {}.\n{}", tools::executor_table(), runtime_versions(), tools::absent_executor_text());
        return tools::ExitStatus::finished;
    };
}

}  // namespace cvtflow::bench
