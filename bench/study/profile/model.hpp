#pragma once
/// Speed-up by a number of threads: three curves and a model of the critical path. Pure functions of costs, then the measurement of these
/// costs and the predictions for the other measurements.

#include <span>
#include <vector>

#include "bench/study/profile/measure.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::bench {

/// Links over the links of the longest of M equal segments: speed-up by M threads if nothing but whole links costs time.
[[nodiscard]] double even_speed_up(int links, int threads) noexcept;
/// Amdahl's law.
[[nodiscard]] double amdahl_speed_up(double serial_share, int threads) noexcept;

/// Growth of the cost of a synchronisation with the number of threads, fitted to measurements.
enum class MeetingLaw {
    linear,       ///< every thread passes the counter's cache line on to the next: fixed + M x growth
    logarithmic,  ///< the line is passed on as in a tree: fixed + log2(M) x growth
};

/// Parts of a step of the fused assembly [s].
struct PathCosts {
    int lanes = 1;                 ///< neighbouring links that kernels take at a time: a group costs the same whether it is full or not
    double free = 0.0;             ///< evaluation of a lane of a group that touches nothing
    double touching = 0.0;         ///< evaluation of a lane of a group with a tip on a sheave
    double border = 0.0;           ///< cost per segment and evaluation: joints and stage states of its two neighbours
    double detect = 0.0;           ///< cost of detection per link
    double controller = 0.0;       ///< cost of the controller per cycle
    double synchronisation = 0.0;  ///< cost per cycle, linear law: fixed part …
    double per_thread = 0.0;       ///< … and part per thread
    double evaluations = 4.0;      ///< runs of the evaluation cycle per step [1]
    double synchronisation_tree = 0.0;  ///< cost per cycle, logarithmic law: fixed part …
    double per_doubling = 0.0;          ///< … and part per doubling
    double stretch =
        1.0;  ///< time of a task on one of several threads over that on a single one: caches and memory are shared, states come from afar
    double jitter = 0.0;        ///< standard deviation of the time of one link's evaluation; that of n links is sqrt(n) times it
    double other_cycles = 0.0;  ///< cost per step besides evaluations and one detection: location, truncation
};

/// Cost of a meeting per cycle, on `threads` threads; none on one.
[[nodiscard]] double meeting(const PathCosts& costs, int threads, MeetingLaw law) noexcept;

/// Mean of the largest of `count` independent normal numbers of mean 0 and variance 1 (Blom's approximation): the delay of the slowest of
/// equal tasks.
[[nodiscard]] double expected_largest(int count) noexcept;

/// Step time of these segments on `threads` threads, each with a contiguous share of them: every cycle takes its slowest thread, the
/// controller, and, with more than one thread, the meeting. Tasks of the method are spread by links, evenly. A single thread with a single
/// segment has no stretch, border or jitter: it is the reference of speed-ups.
/// @param touching for each link, whether it touches
[[nodiscard]] double step_time(const PathCosts& costs, const tasks::Partition& partition, int threads, const std::vector<bool>& touching,
                               double meeting);

/// Speed-up of M equal segments on M threads against one.
[[nodiscard]] double predicted_speed_up(const PathCosts& costs, int threads, const std::vector<bool>& touching,
                                        MeetingLaw law = MeetingLaw::linear);

/// One measured evaluation task: lanes of its groups.
struct SegmentCost {
    int free = 0;
    int touching = 0;
    double seconds = 0.0;  ///< [s]
};

/// Cost of a segment, in lanes. @param touching for each link of the chain, whether it touches
[[nodiscard]] SegmentCost lanes_of(const tasks::Segment& segment, const std::vector<bool>& touching, int lanes);

/// Least squares for `free`, `touching` and `border`. Costs that the samples do not separate (no touching link anywhere) become equal.
void fit_links(std::span<const SegmentCost> samples, PathCosts& costs);

/// Cost of a synchronisation, measured with a number of threads.
struct ThreadCost {
    int threads = 1;
    double seconds = 0.0;  ///< [s]
};

/// Least squares for both laws, no coefficient below zero. A single sample: constant.
void fit_synchronisation(std::span<const ThreadCost> samples, PathCosts& costs);

/// One row of the curves.
struct SpeedUpRow {
    int threads = 1;
    double ideal = 1.0;      ///< M [1]
    double even = 1.0;       ///< N / N_max(M)
    double amdahl = 1.0;     ///< [1]
    double predicted = 1.0;  ///< critical path, linear law [1]
    double low = 1.0;        ///< predicted speed-up if, beyond the measured number, a thread adds `far` times as much
    double high = 1.0;       ///< predicted speed-up if the law is logarithmic and no task is ever late
};

/// Time of a cache line from another chiplet or socket over that from a neighbouring core (typical of present machines; an assumption). [1]
inline constexpr double far = 3.0;

/// Curves for M = 1 … most, up to one link per segment. @param measured number of threads up to which the synchronisation was measured
[[nodiscard]] std::vector<SpeedUpRow> speed_up_curves(const PathCosts& costs, double serial_share, const std::vector<bool>& touching,
                                                      int measured = 2, int most = 64);

/// Synchronisation of `flow` with two threads on a quiet machine [s]: used where it cannot be measured.
inline constexpr double assumed_synchronisation = 0.1e-6;

struct ProfileModel {
    PathCosts costs;
    double serial_share = 0.0;                ///< serial share of the serial fused run
    std::vector<bool> touching;               ///< [links]
    std::vector<ThreadCost> synchronisation;  ///< cycles of the `flow` executor on which all threads came
    bool assumed = false;                     ///< no such cycle with more than one thread: the synchronisation is `assumed_synchronisation`
    bool stretched = false;                   ///< whether the stretch was measured: some fused schedule got all its threads
    double fit_error = 0.0;                   ///< rms residual of the fit of links, over the mean time of a sample
    double serial_step = 0.0;                 ///< step of one segment on one thread, by the model [s]
    std::vector<SpeedUpRow> curves;
};

/// Median time of each task [s]; 0: it never ran.
[[nodiscard]] std::vector<double> median_task_times(const Spans& spans, int tasks);

/// Costs of links from recorded serial runs with two numbers of segments, of detection beside; of controller and evaluations from the first
/// result, which is serial:fused; of the synchronisation from cycles of `flow` on 1, 2, 4 … threads, up to the usable ones, alternating; of
/// the stretch from the recorded fused results that got all their threads. Sets
/// `predicted` of the results: fused ones by the critical path with the synchronisation of their executor, staged ones by the tasks of
/// serial:staged, if that is among them, spread evenly, and the same synchronisation per level.
[[nodiscard]] ProfileModel measure_model(const tasks::Scene& scene, std::vector<ScheduleResult>& results, const MeasureOptions& options);

}  // namespace cvtflow::bench
