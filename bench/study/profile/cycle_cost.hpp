#pragma once
/// Cost of an executor's synchronisation, apart from any chain.

#include "tasks/schedule/schedule.hpp"

namespace cvtflow::bench {

struct CycleCost {
    double seconds = 0.0;  ///< per cycle, above the task's own time [s]
    int active = 0;        ///< threads that ran at least a quarter of their share of tasks
};

/// Cycles of one task of about 2 us per thread, in a graph of one level: their time above that of a single task run serially just before;
/// medians over batches, bounded by wall time. Threads that never come (busy machine) make it meaningless: see `active`.
[[nodiscard]] CycleCost cycle_cost(const tasks::Schedule& schedule, double seconds);

}  // namespace cvtflow::bench
