#pragma once
/// Cost and errors of each level of detail, as a table: `cvtflow-lab detail --levels`.

#include "bench/lab/measure/detail_ladder.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"

namespace cvtflow::bench {

/// Prints a table for every operating point and one of all of them; ladder.csv, .json, .svg if asked for. A failed level is named on stderr
/// and makes the result incomplete.
tools::ExitStatus report_ladder(const DetailArguments& arguments, const tools::OutputArguments& output);

}  // namespace cvtflow::bench
