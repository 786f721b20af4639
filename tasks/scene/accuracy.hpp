#pragma once
/// Reads a target accuracy.

#include <optional>
#include <string_view>

namespace cvtflow::tasks {

/// "1 %", "0.01", as a share [1]; nothing unless above 0 and at most a half.
[[nodiscard]] std::optional<double> read_accuracy(std::string_view text);

}  // namespace cvtflow::tasks
