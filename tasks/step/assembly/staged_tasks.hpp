#pragma once
/// Bodies of the tasks of the staged assembly: context is the workspace.

namespace cvtflow::tasks {

/// Stage state of one segment's links.
void combine_segment(void* workspace, int segment) noexcept;
/// Contact forces of one batch of touching links; as many batches as segments, of equal size whatever the segments hold.
void contact_batch(void* workspace, int batch) noexcept;
/// Elasticity and plates of one segment's links, joints of the pins strictly between them.
void chain_segment(void* workspace, int segment) noexcept;
/// Joint of the pin between a segment and the one before it.
void boundary_pin(void* workspace, int segment) noexcept;
void forward_segment(void* workspace, int segment) noexcept;
void reverse_segment(void* workspace, int segment) noexcept;
/// All segments in one task.
void forward_all(void* workspace, int) noexcept;
void reverse_all(void* workspace, int) noexcept;
void detect_all(void* workspace, int) noexcept;

}  // namespace cvtflow::tasks
