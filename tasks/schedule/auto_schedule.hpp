#pragma once
/// Candidate schedules of a scene with run.schedule = "auto".

#include <vector>

#include "tasks/schedule/schedule.hpp"

namespace cvtflow::tasks {

/// The scene's own schedule, or, if run.schedule is "auto", what is worth trying: serial first, then `flow` in both assemblies, with one
/// segment and two segments per thread, with equal and with balanced segments, and on half the threads where there are four or more.
/// Numbers of segments and threads that the scene gives are respected, and so are assembly and partition if they are not the usual ones.
/// Only serial on one usable processor.
/// @throws SceneError for an executor that does not exist
[[nodiscard]] std::vector<Schedule> schedules_for(const Scene& scene);

/// Segments, and with them threads, that a step of this machine can be cut into: rigid pins are one, everything else as many as links.
[[nodiscard]] int max_segments(const model::Parameters& parameters) noexcept;

}  // namespace cvtflow::tasks
