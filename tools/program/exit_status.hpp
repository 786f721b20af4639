#pragma once
/// What the program returns to its caller. Scripts rely on these numbers.

#include <string_view>

#include "tasks/run/run.hpp"

namespace cvtflow::tools {

enum class ExitStatus {
    finished = 0,
    error = 1,       ///< scene, file or anything else that kept the command from its work
    usage = 2,       ///< command line
    fault = 3,       ///< the simulation ran into a state that it cannot continue from
    budget = 4,      ///< run.max_steps or run.max_wall used up
    incomplete = 5,  ///< a sweep whose cases, or a comparison whose variants, did not all end well; shards or cases that are missing
    unreliable = 6,  ///< a run that finished and whose energy balance says that its results are wrong
    inaccurate = 7,  ///< nothing that was tried is as accurate as wanted, or a sweep is not where it was verified
    cancelled = 130  ///< interrupted by SIGINT, SIGTERM, SIGHUP, SIGXCPU or SIGPIPE; as shells report the first
};

[[nodiscard]] ExitStatus exit_status(tasks::FaultKind kind) noexcept;

[[nodiscard]] ExitStatus exit_status(const tasks::RunReport& report) noexcept;

/// The table above for --help.
inline constexpr std::string_view exit_status_help =
    "Exit status:\n"
    "  0    finished\n"
    "  1    error in the scene or a file\n"
    "  2    error on the command line\n"
    "  3    the run ended by itself: state not finite, tip too deep, pin off its sheave,\n"
    "       step too short\n"
    "  4    budget used up: run.max_steps, run.max_wall\n"
    "  5    cases of a sweep (variants of detail) failed or are missing\n"
    "  6    finished, but the energy balance does not close: the results are unreliable\n"
    "  7    not as accurate as wanted: tune, run --accuracy, sweeps with [accuracy]\n"
    "  130  interrupted; the record is complete up to there";

}  // namespace cvtflow::tools
