#pragma once
/// The subcommands of cvtflow-lab: a file in a folder of bench/lab/command and a row in main.cpp each.

#include "tools/program/program.hpp"

namespace cvtflow::bench {

tools::Action declare_local_error(CLI::App& app);
tools::Action declare_method(CLI::App& app);
tools::Action declare_compare(CLI::App& app);
tools::Action declare_spectrum(CLI::App& app);
tools::Action declare_stability(CLI::App& app);
tools::Action declare_profile(CLI::App& app);
tools::Action declare_granularity(CLI::App& app);
tools::Action declare_dot(CLI::App& app);
tools::Action declare_work(CLI::App& app);
tools::Action declare_sweep_cost(CLI::App& app);
tools::Action declare_run_cost(CLI::App& app);
tools::Action declare_executors(CLI::App& app);
tools::Action declare_extremes(CLI::App& app);
tools::Action declare_lottery(CLI::App& app);
tools::Action declare_belt(CLI::App& app);

}  // namespace cvtflow::bench
