#pragma once
/// The subcommands of cvtflow, each with a row in tools/program/main.cpp.

#include "tools/program/program.hpp"

namespace cvtflow::tools {

Action declare_run(CLI::App& app);
Action declare_resume(CLI::App& app);
Action declare_batch(CLI::App& app);
Action declare_table(CLI::App& app);
Action declare_merge(CLI::App& app);
Action declare_diff(CLI::App& app);
Action declare_settle(CLI::App& app);
Action declare_check(CLI::App& app);
Action declare_info(CLI::App& app);
Action declare_export(CLI::App& app);
Action declare_list(CLI::App& app);
Action declare_explain(CLI::App& app);
Action declare_schema(CLI::App& app);
Action declare_tune(CLI::App& app);
Action declare_plot(CLI::App& app);
Action declare_report(CLI::App& app);
Action declare_export_fmu(CLI::App& app);

}  // namespace cvtflow::tools
