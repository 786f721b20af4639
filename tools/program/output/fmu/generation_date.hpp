#pragma once
/// When an FMU was made, such that the same program and scene make the same file.

#include <string>

namespace cvtflow::tools {

/// SOURCE_DATE_EPOCH [s since 1970], else the date of the commit that this program was built from: UTC, ISO 8601. Empty if neither is
/// known.
/// @throws UsageError for a SOURCE_DATE_EPOCH that is no number of seconds
[[nodiscard]] std::string generation_date();

}  // namespace cvtflow::tools
