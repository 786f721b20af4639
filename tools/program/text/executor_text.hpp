#pragma once
/// The catalogue of executors as text.

#include <string>

namespace cvtflow::tools {

/// A row per executor of this program.
[[nodiscard]] std::string executor_table();
/// Executors that this build lacks, and their requirements; empty if none is missing.
[[nodiscard]] std::string absent_executor_text();

}  // namespace cvtflow::tools
