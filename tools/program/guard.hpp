#pragma once
/// End and reports of a process: exit status, messages, signals, standard streams.

#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "engine/executor/cancellation.hpp"
#include "tasks/run/exit_status.hpp"
#include "tasks/run/run.hpp"

namespace cvtflow::tools {

using tasks::ExitStatus;

[[nodiscard]] ExitStatus exit_status(const tasks::RunReport& report) noexcept;

/// The last line of a command's --help.
inline constexpr std::string_view exit_status_help = "Exit status: 0 finished; the other numbers are in cvtflow --help.";

/// All exit statuses with their meanings, for the program's --help.
[[nodiscard]] std::string exit_status_table();

/// Invalid option value, or options that exclude each other: exit status 2.
class UsageError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Writes to stderr unchanged. A closed or full stderr is ignored.
void to_stderr(std::string_view text) noexcept;

/// Sets the program's name, the prefix of its messages (initially "cvtflow"). The text must outlive all messages.
void name_program(std::string_view name) noexcept;
[[nodiscard]] std::string_view program_name() noexcept;

/// Prints to stderr, with "cvtflow: " before each line that is not indented.
void print_error(std::string_view message);

/// Prints a message as print_error() does, unless it is empty or the command shall be quiet.
void say(bool quiet, std::string_view message);

/// Prints a notice to stderr if fewer threads were available than requested.
void print_notices();

/// Exit status of `work`. Prints the message of an exception that it throws.
[[nodiscard]] int guarded(const std::function<int()>& work) noexcept;

/// Ignores SIGXFSZ, so that a write beyond the limit of file sizes fails instead of ending the process. Opens descriptors 0 to 2 if the
/// parent closed them, so that no result file gets their numbers; writing to them fails.
void take_standard_descriptors() noexcept;

/// Flushes stdout. @return the status, or `error`, with a message, if stdout cannot be written and status is 0
[[nodiscard]] int finish_output(int status) noexcept;

/// Installs handlers: engine::ending_signals() set the returned flag. A further signal of a user (not SIGXCPU, not SIGPIPE) at least half a
/// second later ends the program at once.
[[nodiscard]] const engine::Cancellation& catch_interrupts();

}  // namespace cvtflow::tools
