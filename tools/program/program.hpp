#pragma once
/// Commands, arguments, help and exit status, which cvtflow and cvtflow-lab share; and the commands of cvtflow.

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "tools/program/guard.hpp"

namespace CLI {
class App;
}

namespace cvtflow::tools {

/// Runs a command after its arguments are read. If it throws, what() is printed as the error.
using Action = std::function<ExitStatus()>;

struct Command {
    std::string_view name;
    std::string_view group;            ///< heading in the help text
    std::string_view description;      ///< one line
    Action (*declare)(CLI::App& app);  ///< declares arguments; they live in the returned action. nullptr: a command of Python
};

struct Program {
    std::string_view name;              ///< "cvtflow"
    std::string_view description;       ///< one line
    std::span<const Command> commands;  ///< commands in the order of the help text
    std::string_view first_steps;       ///< lines of the help text
    std::string_view other;             ///< the other program, suggested for unknown commands
};

/// main() of a program. @return its exit status
[[nodiscard]] int run_program(const Program& program, int argc, char** argv) noexcept;

/// Command and arguments of this process, without --isa.
[[nodiscard]] std::span<const std::string> given_words() noexcept;

/// The subcommands of cvtflow, each with a row in tools/program/main.cpp.
Action declare_run(CLI::App& app);
Action declare_resume(CLI::App& app);
Action declare_batch(CLI::App& app);
Action declare_settle(CLI::App& app);
Action declare_check(CLI::App& app);
Action declare_info(CLI::App& app);
Action declare_list(CLI::App& app);
Action declare_explain(CLI::App& app);
Action declare_schema(CLI::App& app);

}  // namespace cvtflow::tools
