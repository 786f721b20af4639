#pragma once
/// The part of a page that compares several records.

#include <string>
#include <vector>

#include "tools/program/view/recorded_run.hpp"

namespace cvtflow::tools {

/// Every further record against the first: keys of the scenes that differ, key figures side by side, curves of the differences. HTML.
[[nodiscard]] std::string difference_body(const std::vector<RecordedRun>& runs);

}  // namespace cvtflow::tools
