#pragma once
/// How fast a sweep runs, against its bare step loop.

#include <string>
#include <vector>

#include "tasks/batch/sweep/sweep.hpp"

namespace cvtflow::bench {

struct BatchTiming {
    int threads = 0;    ///< 0: the bare step loop, one thread
    double wall = 0.0;  ///< median over the rounds [s]
    double cpu = 0.0;   ///< of all threads, median; what counts on a busy machine [s]
};

struct BatchBench {
    long cases = 0, evaluations = 0;
    std::vector<BatchTiming> timings;  ///< the bare loop first
    double peak_memory = 0.0;          ///< of the process so far [byte]
    std::string results_hash;          ///< equal for all, or an error is thrown
};

/// Runs the sweep by turns as a bare loop (every case begun in the same memory and integrated by a silent observer; starts are made
/// beforehand) and as a batch on each number of threads.
/// Results go to a folder of its own, which it removes. @throws as run_batch; SimulationError if hashes differ
[[nodiscard]] BatchBench bench_batch(const tasks::Sweep& sweep, const std::vector<int>& threads, int rounds);

}  // namespace cvtflow::bench
