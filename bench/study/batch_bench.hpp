#pragma once
/// Speed of a sweep and of a run, against their bare step loop.

#include <string>
#include <vector>

#include "tasks/batch/sweep/sweep.hpp"

namespace cvtflow::bench {

struct BatchTiming {
    int threads = 0;    ///< 0: the bare step loop, one thread
    double wall = 0.0;  ///< median over the rounds [s]
    double cpu = 0.0;   ///< processor time of all threads, median; the measure on a busy machine [s]
};

struct BatchBench {
    long cases = 0, evaluations = 0;
    std::vector<BatchTiming> timings;  ///< the bare loop first
    double peak_memory = 0.0;          ///< peak memory of the process so far [byte]
    std::string results_hash;          ///< equal for all, or an error is thrown
};

/// Runs the sweep by turns as a bare loop (every case begun in the same memory and integrated by a silent observer; starts are made
/// beforehand) and as a batch on each number of threads.
/// Results go to a temporary folder. @throws as run_batch; SimulationError if hashes differ
[[nodiscard]] BatchBench bench_batch(const tasks::Sweep& sweep, const std::vector<int>& threads, int rounds);

/// Processor time of a run [s], settling included.
struct RunCost {
    double unwatched;  ///< steps alone: no output is computed, energies are not watched
    double bare;       ///< simulation with a silent observer: no output is computed, energies are watched as in every run
    double observed;   ///< simulation with outputs and the summary, but no record
    double recorded;   ///< simulation with a record of the scene's channels
};

/// Runs the scene in all four ways by turns, on one thread; one element per round. The record goes to a folder that is removed.
/// @throws as run_scene
[[nodiscard]] std::vector<RunCost> bench_run(const tasks::Scene& scene, int rounds);

}  // namespace cvtflow::bench
