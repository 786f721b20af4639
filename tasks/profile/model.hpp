#pragma once
/// What a number of threads can bring: three curves and a model of the critical path. Pure functions of measured costs.

#include <span>
#include <vector>

#include "tasks/partition.hpp"

namespace cvtflow::tasks {

/// Links over the links of the longest of M equal segments: what M threads bring if nothing but whole links costs time.
[[nodiscard]] double even_speed_up(int links, int threads) noexcept;
/// Amdahl's law.
[[nodiscard]] double amdahl_speed_up(double serial_share, int threads) noexcept;

/// What a step of the fused assembly is made of [s].
struct PathCosts {
    double free = 0.0;               ///< evaluation of a link that touches nothing
    double touching = 0.0;           ///< evaluation of a link with a tip on a sheave
    double border = 0.0;             ///< per segment and evaluation: joints and stage states of its two neighbours
    double detect = 0.0;             ///< detection, per link
    double controller = 0.0;         ///< per cycle
    double synchronisation = 0.0;    ///< per cycle: fixed part …
    double per_thread = 0.0;         ///< … and what each thread adds
    double evaluations = 4.0;        ///< per step
};

/// Step time of M segments on M threads: every cycle takes its slowest segment, the controller, and, with more than one thread, the synchronisation.
/// @param touching of each link, whether it touches
[[nodiscard]] double step_time(const PathCosts& costs, const Partition& partition, const std::vector<bool>& touching);

/// Speed-up of M equal segments on M threads against one.
[[nodiscard]] double predicted_speed_up(const PathCosts& costs, int threads, const std::vector<bool>& touching);

/// One measured evaluation task.
struct SegmentCost {
    int free = 0;
    int touching = 0;
    double seconds = 0.0;
};

/// Least squares for `free`, `touching` and `border`. Costs that the samples cannot tell apart (no touching link anywhere) become equal.
void fit_links(std::span<const SegmentCost> samples, PathCosts& costs);

/// Cost of a synchronisation, measured with a number of threads.
struct ThreadCost {
    int threads = 1;
    double seconds = 0.0;
};

/// Least squares for synchronisation + per_thread x M, neither below zero. A single sample: constant.
void fit_synchronisation(std::span<const ThreadCost> samples, PathCosts& costs);

/// One row of the curves.
struct SpeedUpRow {
    int threads = 1;
    double ideal = 1.0;       ///< M
    double even = 1.0;        ///< N / N_max(M)
    double amdahl = 1.0;
    double predicted = 1.0;   ///< critical path
};

/// For M = 1 … most, up to one link per segment.
[[nodiscard]] std::vector<SpeedUpRow> speed_up_curves(const PathCosts& costs, double serial_share, const std::vector<bool>& touching, int most = 64);

}  // namespace cvtflow::tasks
