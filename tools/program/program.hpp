#pragma once
/// Shared by cvtflow and cvtflow-lab: commands, arguments, help, exit status.

#include <functional>
#include <span>
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
    Action (*declare)(CLI::App& app);  ///< declares arguments; they live in the returned action
};

struct Program {
    std::string_view name;              ///< "cvtflow"
    std::string_view description;       ///< one line
    std::span<const Command> commands;  ///< in the order of the help text
    std::string_view first_steps;       ///< lines of the help text
    std::string_view other;             ///< the other program, suggested for unknown commands
};

/// main() of a program. @return its exit status
[[nodiscard]] int run_program(const Program& program, int argc, char** argv) noexcept;

}  // namespace cvtflow::tools
