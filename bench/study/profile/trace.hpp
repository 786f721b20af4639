#pragma once
#include <string>

#include "bench/study/profile/profile.hpp"

namespace cvtflow::bench {

/// The recorded passes in Chrome's trace format (chrome://tracing, ui.perfetto.dev): a process per schedule, a track per thread. Each
/// begins at 0.
[[nodiscard]] std::string profile_trace(const Profile& profile);

}  // namespace cvtflow::bench
