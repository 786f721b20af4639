#pragma once
/// The page of a record, or of several beside each other.

#include <string>
#include <vector>

#include "tools/program/view/recorded_run.hpp"

namespace cvtflow::tools {

/// One document; the chain runs in that of the first record. @throws std::runtime_error see text_of(Page)
[[nodiscard]] std::string run_page(const std::vector<RecordedRun>& runs);

}  // namespace cvtflow::tools
