#pragma once
/// Measured parts of the critical-path model, and its predictions for the other measurements.

#include "bench/study/profile/measure.hpp"
#include "bench/study/profile/model.hpp"

namespace cvtflow::bench {

/// Synchronisation of `flow` with two threads on a quiet machine [s]: what the model takes where it cannot be measured.
inline constexpr double assumed_synchronisation = 0.1e-6;

struct ProfileModel {
    PathCosts costs;
    double serial_share = 0.0;                ///< of the serial fused run [1]
    std::vector<bool> touching;               ///< [links]
    std::vector<ThreadCost> synchronisation;  ///< cycles of the `flow` executor on which all threads came
    bool assumed = false;                     ///< no such cycle with more than one thread: the synchronisation is `assumed_synchronisation`
    bool stretched = false;                   ///< whether the stretch was measured: some fused schedule got all its threads
    double fit_error = 0.0;                   ///< rms of what the fit of links leaves, over the mean time of a sample [1]
    double serial_step = 0.0;                 ///< of one segment on one thread, by the model [s]
    std::vector<SpeedUpRow> curves;
};

/// Median time of each task [s]; 0: it never ran.
[[nodiscard]] std::vector<double> median_task_times(const Spans& spans, int tasks);

/// Costs of links from recorded serial runs with two numbers of segments, of detection beside; of controller and evaluations from the first
/// result, which is serial:fused; of the synchronisation from cycles of `flow` on 1, 2, 4 … threads, up to the usable ones, alternating; of
/// the stretch from the recorded fused results that got all their threads. Sets
/// `predicted` of the results: fused ones by the critical path with their executor's own synchronisation, staged ones by the tasks of
/// serial:staged, if that is among them, spread evenly, and their executor's synchronisation per level.
[[nodiscard]] ProfileModel measure_model(const tasks::Scene& scene, std::vector<ScheduleResult>& results, const MeasureOptions& options);

}  // namespace cvtflow::bench
