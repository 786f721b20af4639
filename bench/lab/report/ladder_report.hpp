#pragma once
/// What each level of detail costs and how far it is off, as a table: `cvtflow-lab detail --rungs`.

#include "bench/lab/measure/detail_ladder.hpp"
#include "tools/program/exit_status.hpp"
#include "tools/program/output/output_folder.hpp"

namespace cvtflow::bench {

/// Prints a table for every operating point and one of all of them; ladder.csv, .json, .svg if asked for. A level that broke down is named
/// on stderr and makes the result incomplete.
tools::ExitStatus report_ladder(const DetailArguments& arguments, const tools::OutputArguments& output);

}  // namespace cvtflow::bench
