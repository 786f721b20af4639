#pragma once
/// The last line of defence of a process.

#include <functional>
#include <stdexcept>
#include <string_view>

#include "tools/program/exit_status.hpp"

namespace cvtflow::tools {

/// An option's value, or options that do not go together: exit status 2.
class UsageError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// To stderr as it is; a stderr that is closed or full is no reason to end a run.
void to_stderr(std::string_view text) noexcept;

/// The name of this process's program, which its messages begin with: "cvtflow" until it is named. Must outlive the process's messages.
void name_program(std::string_view name) noexcept;
[[nodiscard]] std::string_view program_name() noexcept;

/// On stderr, "cvtflow: " before each line that does not go on the one before.
void print_error(std::string_view message);

/// On stderr, what a user should know beside the result: threads that were not to be had.
void print_notices();

/// Exit status of `work`; what it throws is printed.
[[nodiscard]] int guarded(const std::function<int()>& work) noexcept;

/// Makes writes fail that would otherwise end the process or go astray: beyond the limit of file sizes (no SIGXFSZ); descriptors 0 to 2
/// that a parent has closed are taken, so that no file of results gets their numbers; what is printed there fails.
void take_standard_descriptors() noexcept;

/// Writes out what was printed. @return the status; if stdout cannot be written and that was no error yet, error, which is said
[[nodiscard]] int finish_output(int status) noexcept;

}  // namespace cvtflow::tools
