#pragma once
/// End and reports of a process: exit status, messages, signals, standard streams.

#include <functional>
#include <stdexcept>
#include <string_view>

#include "engine/executor/cancellation.hpp"
#include "tasks/run/run.hpp"

namespace cvtflow::tools {

enum class ExitStatus {
    finished = 0,
    error = 1,       ///< invalid scene or file, or another failure of the command
    usage = 2,       ///< invalid command line
    fault = 3,       ///< the simulation cannot continue: see tasks::FaultKind
    budget = 4,      ///< run.max_steps, run.max_wall or the budget of tuning used up
    incomplete = 5,  ///< cases of a sweep or variants of a comparison failed or are missing
    unreliable = 6,  ///< finished, but the energy balance does not close: the results are wrong
    inaccurate = 7,  ///< target accuracy missed by every tried choice, or by a sweep at its verified cases; means not steady
    missed = 8,      ///< finished, but the machine does not follow its cycle
    cancelled = 130  ///< interrupted by SIGINT, SIGTERM, SIGHUP, SIGXCPU or SIGPIPE; as shells report the first
};

[[nodiscard]] ExitStatus exit_status(const tasks::RunReport& report) noexcept;

/// The last line of a command's --help.
inline constexpr std::string_view exit_status_help = "Exit status: 0 finished; the other numbers are in cvtflow --help.";

/// The table above for the program's --help.
inline constexpr std::string_view exit_status_table =
    "Exit status:\n"
    "  0    finished\n"
    "  1    error in the scene or a file\n"
    "  2    error on the command line\n"
    "  3    the run ended early: state not finite, tip too deep, pin off its sheave,\n"
    "       step too short\n"
    "  4    budget used up: run.max_steps, run.max_wall, --budget\n"
    "  5    cases of a sweep (variants of detail) failed or are missing\n"
    "  6    finished, but the energy balance does not close: the results are unreliable\n"
    "  7    target accuracy missed: tune, run --accuracy, sweeps with [accuracy];\n"
    "       means not steady at run.steady_limit\n"
    "  8    finished, but the machine misses its cycle by more than 2 % (cycle_missed)\n"
    "  130  interrupted; the record is complete up to the interruption";

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
