#pragma once
/// Cost and errors of each key of detail, as a table: `cvtflow-lab detail`.

#include "bench/lab/measure/detail_measure.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"

namespace cvtflow::bench {

/// Prints a table for every scene, differences from full detail; detail_SCENE.csv, .json, .svg if asked for. A failed variant is named on
/// stderr and makes the result incomplete.
tools::ExitStatus report_details(const DetailArguments& arguments, const tools::OutputArguments& output);

}  // namespace cvtflow::bench
