#pragma once
/// The subcommands: a file in a folder of tools/program/command and a row in commands.cpp each.

#include <functional>
#include <span>
#include <string_view>

#include "tools/program/exit_status.hpp"

namespace CLI {
class App;
}

namespace cvtflow::tools {

/// What a subcommand does once its arguments are read. May throw; what() is then printed as the error.
using Action = std::function<ExitStatus()>;

struct Command {
    std::string_view name;
    std::string_view group;            ///< heading of the help text that it stands under: a folder of tools/program/command
    std::string_view description;      ///< one line
    Action (*declare)(CLI::App& app);  ///< declares arguments; they live in the returned action
};

/// In the order of the help text.
[[nodiscard]] std::span<const Command> commands() noexcept;

Action declare_run(CLI::App& app);
Action declare_resume(CLI::App& app);
Action declare_batch(CLI::App& app);
Action declare_table(CLI::App& app);
Action declare_merge(CLI::App& app);
Action declare_settle(CLI::App& app);
Action declare_check(CLI::App& app);
Action declare_info(CLI::App& app);
Action declare_export(CLI::App& app);
Action declare_list(CLI::App& app);
Action declare_explain(CLI::App& app);
Action declare_schema(CLI::App& app);
Action declare_local_error(CLI::App& app);
Action declare_method(CLI::App& app);
Action declare_fit(CLI::App& app);
Action declare_compare(CLI::App& app);
Action declare_spectrum(CLI::App& app);
Action declare_stability(CLI::App& app);
Action declare_pin_entry(CLI::App& app);
Action declare_profile(CLI::App& app);
Action declare_granularity(CLI::App& app);
Action declare_dot(CLI::App& app);
Action declare_newton(CLI::App& app);
Action declare_detail(CLI::App& app);
Action declare_tune(CLI::App& app);
Action declare_tradeoff(CLI::App& app);
Action declare_extremes(CLI::App& app);
Action declare_lottery(CLI::App& app);
Action declare_plot(CLI::App& app);
Action declare_report(CLI::App& app);
Action declare_export_fmu(CLI::App& app);

}  // namespace cvtflow::tools
