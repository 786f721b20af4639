#pragma once
/// The last line of defence of a process.

#include <functional>
#include <string_view>

#include "tools/exit_status.hpp"

namespace cvtflow::tools {

/// On stderr, "cvtflow: " before each line that does not go on the one before.
void print_error(std::string_view message);

/// On stderr, what a user should know beside the result: threads that were not to be had.
void print_notices();

/// Exit status of `work`; what it throws is printed.
[[nodiscard]] int guarded(const std::function<int()>& work) noexcept;

}  // namespace cvtflow::tools
