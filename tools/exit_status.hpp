#pragma once
/// What the program returns to its caller. Scripts rely on these numbers.

#include <string_view>

#include "tasks/fault.hpp"

namespace cvtflow::tools {

enum class ExitStatus {
    finished = 0,
    error = 1,       ///< scene, file or anything else that kept the command from its work
    usage = 2,       ///< command line
    fault = 3,       ///< the simulation ran into a state that it cannot continue from
    budget = 4,      ///< run.max_steps or run.max_wall used up
    incomplete = 5,  ///< a sweep whose cases did not all end well; shards or cases that are missing
    cancelled = 130  ///< interrupted by SIGINT, SIGTERM, SIGHUP, SIGXCPU or SIGPIPE; as shells report the first
};

[[nodiscard]] ExitStatus exit_status(tasks::FaultKind kind) noexcept;

/// The table above for --help.
inline constexpr std::string_view exit_status_help =
    "Exit status:\n"
    "  0    finished\n"
    "  1    error in the scene or a file\n"
    "  2    error on the command line\n"
    "  3    the run ended by itself: state not finite, tip too deep, pin off its sheave,\n"
    "       step too short\n"
    "  4    budget used up: run.max_steps, run.max_wall\n"
    "  5    cases of a sweep failed or are missing\n"
    "  130  interrupted; the record is complete up to there";

}  // namespace cvtflow::tools
