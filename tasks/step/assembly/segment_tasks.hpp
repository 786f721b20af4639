#pragma once
/// What one segment does in each cycle. Bodies of tasks: context is the workspace, item the segment.

#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

/// Stage state of a segment's links and of the layout's halo on each side, as workspace.step.row combines it. @param window room for them;
/// window [unknowns]
void fill_window(Workspace& workspace, const Segment& own, double* window) noexcept;

/// The window of a given state vector, such as the end of the step.
void copy_window(const Workspace& workspace, const Segment& own, const double* state, double* window) noexcept;

/// The window of a state vector in the segment's own memory, which is returned.
[[nodiscard]] const double* window_of(Workspace& workspace, const double* state, int segment) noexcept;

/// The accounts of a segment's links, all zero.
[[nodiscard]] model::Account* cleared_accounts(Workspace& workspace, const Segment& own) noexcept;

/// Stage state of the segment and its halo, forces, slope of its links.
void evaluate_segment(void* workspace, int segment) noexcept;
/// Losses and stored energies of its links at the step's start, kinetic ones too, into workspace.links.accounts; on
/// workspace.pulleys.observed_sheaves.
void observe_segment(void* workspace, int segment) noexcept;
/// Result of the step for its links; their tips at the step's end.
void detect_segment(void* workspace, int segment) noexcept;
/// Earliest transition of its tips.
void locate_segment(void* workspace, int segment) noexcept;
/// State of its links at theta; its tips take the phase that is due there.
void truncate_segment(void* workspace, int segment) noexcept;

}  // namespace cvtflow::tasks
