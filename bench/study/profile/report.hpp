#pragma once
/// A profile as CSV and trace, with the origin of its numbers. Tables for people: bench/lab/command/schedule/profile.cpp.

#include <string>

#include "bench/study/profile/profile.hpp"

namespace cvtflow::bench {

/// Flags that this program was compiled with.
[[nodiscard]] std::string compiler_flags();

/// One row per schedule and load, provenance in every row; times in microseconds.
[[nodiscard]] std::string profile_csv(const tasks::Scene& scene, const Profile& profile);

/// Stages of the recorded passes, one row per schedule, thread and stage: the published chart of times per thread, and of serial:staged the
/// one of sequential time.
[[nodiscard]] std::string profile_stages_csv(const tasks::Scene& scene, const Profile& profile);

/// The recorded passes in Chrome's trace format (chrome://tracing, ui.perfetto.dev): a process per schedule, a track per thread. Each
/// begins at 0.
[[nodiscard]] std::string profile_trace(const Profile& profile);

}  // namespace cvtflow::bench
