#pragma once
/// The one kernel of every method: a linear combination of slots over a range of the state vector.

#include "engine/method/compiled_plan.hpp"

namespace cvtflow::engine {

/// Where the slots of a step lie: arrays of pointers to whole state vectors.
struct SlotView {
    const double* const* states;  ///< [state slot] → y [state]
    const double* const* slopes;  ///< [slope slot] → y' [state/s]
};

/// out[i - begin] = Σ factor states[slot][i] + Σ (h factor) slopes[slot][i] for i in [begin, end).
/// Terms are added per element from left to right, states first: results are bitwise the same however a range is split.
/// @param out end - begin numbers; overlaps no slot that the step reads
/// No terms at all: zeros. Never fails, allocates nothing.
void combine(const PlanStep& step, double h, const SlotView& slots, int begin, int end, double* out) noexcept;

}  // namespace cvtflow::engine
