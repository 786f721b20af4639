#pragma once
/// The page of a record, or of several beside each other.

#include <string>
#include <vector>

#include "tools/program/view/recorded_run.hpp"
#include "tools/program/view/sweep_view.hpp"

namespace cvtflow::tools {

/// One document; the chain runs in that of the first record. @throws std::runtime_error see text_of(Page)
[[nodiscard]] std::string run_page(const std::vector<RecordedRun>& runs);

/// One document: how its cases ended, a picture of any columns over any others, all cases as a table that can be sorted.
/// @throws std::runtime_error see text_of(Page)
[[nodiscard]] std::string sweep_page(const SweepView& sweep);

}  // namespace cvtflow::tools
