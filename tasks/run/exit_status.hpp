#pragma once
/// How a command ended, as the exit status of its process; hosts learn the same numbers (cvtflow_describe).

#include <string_view>

namespace cvtflow::tasks {

enum class ExitStatus {
    finished = 0,
    error = 1,       ///< invalid scene or file, or another failure of the command
    usage = 2,       ///< invalid command line
    fault = 3,       ///< the simulation cannot continue: see FaultKind
    budget = 4,      ///< run.max_steps, run.max_wall or the budget of tuning used up
    incomplete = 5,  ///< cases of a sweep or variants of a comparison failed or are missing
    unreliable = 6,  ///< finished, but the energy balance does not close: the results are wrong
    inaccurate = 7,  ///< target accuracy missed by every tried choice, or by a sweep at its verified cases; means not steady
    missed = 8,      ///< finished, but the machine does not follow its cycle
    cancelled = 130  ///< interrupted by SIGINT, SIGTERM, SIGHUP, SIGXCPU or SIGPIPE; as shells report the first
};

/// An exit status for people.
struct ExitStatusRow {
    ExitStatus status;
    std::string_view meaning;
};

inline constexpr ExitStatusRow exit_statuses[] = {
    {ExitStatus::finished, "finished"},
    {ExitStatus::error, "error in the scene or a file"},
    {ExitStatus::usage, "error on the command line"},
    {ExitStatus::fault, "the run ended early: state not finite, tip too deep, pin off its sheave, step too short"},
    {ExitStatus::budget, "budget used up: run.max_steps, run.max_wall"},
    {ExitStatus::incomplete, "cases of a sweep (variants of detail) failed or are missing"},
    {ExitStatus::unreliable, "finished, but the energy balance does not close: the results are unreliable"},
    {ExitStatus::inaccurate, "target accuracy missed: tune, run --accuracy, sweeps with [accuracy]; means not steady at run.steady_limit"},
    {ExitStatus::missed, "finished, but the machine misses its cycle by more than 2 % (cycle_missed)"},
    {ExitStatus::cancelled, "interrupted; the record is complete up to the interruption"},
};

}  // namespace cvtflow::tasks
