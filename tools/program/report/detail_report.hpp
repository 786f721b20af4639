#pragma once
/// What each dial of detail costs and changes, as a table: `cvtflow detail` and `cvtflow tradeoff --detail`.

#include "tools/program/exit_status.hpp"
#include "tools/program/measure/detail_measure.hpp"
#include "tools/program/output/output_folder.hpp"

namespace cvtflow::tools {

/// Prints a table for every scene, differences from full detail; detail_SCENE.csv, .json, .svg if asked for. A variant that broke down is
/// named on stderr and makes the result incomplete.
ExitStatus report_details(const DetailArguments& arguments, const OutputArguments& output);

}  // namespace cvtflow::tools
