#pragma once
/// The published schedule as an assembly of the step: every stage its own tasks, contact forces in uniform batches of touching links beside
/// chain forces by segments, then the boundary pins, forward pass, reverse pass.

namespace cvtflow::bench {

/// Adds it to the product's, once per process, before any workspace is made. Until then run.assembly = "staged" is refused.
void add_staged_assembly();

}  // namespace cvtflow::bench
