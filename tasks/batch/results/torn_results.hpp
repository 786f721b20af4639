#pragma once
/// Recovers a sweep whose table can no longer be opened: intact rows are kept, the other cases run again.

#include <optional>
#include <string>
#include <string_view>

#include "engine/record/case_table.hpp"

namespace cvtflow::tasks {

/// With what every mark begins.
inline constexpr std::string_view mark_of_a_sweep = "rows of the sweep ";

/// Says in a line what a table is of, as an attribute whose text is found in the file's bytes: a hash of what the results depend on, the
/// shard and the columns. Tables of equal marks hold rows of the same sweep.
void set_mark(engine::CaseTable& table);

/// The rows of a table that was growing when power went. @param begin  that sweep's, without rows, marked
/// @return nothing if the file is not known to be of that sweep, or was finished
[[nodiscard]] std::optional<engine::CaseTable> recover_results(const std::string& path, const engine::CaseTable& begin);

}  // namespace cvtflow::tasks
