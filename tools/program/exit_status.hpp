#pragma once
/// Exit status of the program. Scripts rely on these numbers.

#include <string_view>

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
    inaccurate = 7,  ///< target accuracy missed by every tried choice, or by a sweep at its verified cases
    cancelled = 130  ///< interrupted by SIGINT, SIGTERM, SIGHUP, SIGXCPU or SIGPIPE; as shells report the first
};

[[nodiscard]] ExitStatus exit_status(tasks::FaultKind kind) noexcept;

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
    "  7    target accuracy missed: tune, run --accuracy, sweeps with [accuracy]\n"
    "  130  interrupted; the record is complete up to the interruption";

}  // namespace cvtflow::tools
