#pragma once
/// Everything that a profile of a scene's schedules measures, in the order in which it is measured.

#include <functional>

#include "bench/study/profile/measure.hpp"

namespace cvtflow::bench {

/// Schedules that are compared.
struct ScheduleChoice {
    std::vector<std::string>
        names{};                  ///< "executor" (the scene's assembly) or "executor:fused", "executor:staged"; none: all executors x both
    std::vector<int> threads{};   ///< none: as many as are usable
    std::vector<int> segments{};  ///< 0: as many as threads; none: 0
    engine::Wait wait = engine::Wait::balanced;  ///< waiting of cvtflow's executors
    bool pin = false;                            ///< each thread on one processor
};

/// The schedules of a choice, serial:fused with one segment first, none twice. Executors of one thread appear once per assembly.
/// @throws SceneError for an executor or assembly that does not exist, or more segments than links
[[nodiscard]] std::vector<tasks::Schedule> chosen_schedules(const tasks::Scene& scene, const ScheduleChoice& choice);

/// Cost of a synchronisation with a number of threads.
struct ThreadCost {
    int threads = 1;
    double seconds = 0.0;  ///< [s]
};

struct Profile {
    std::vector<ScheduleResult> results;   ///< the first is serial:fused
    StageTable stages;                     ///< stages of all results
    std::vector<ThreadCost> bare;          ///< bare barrier by number of threads [s per cycle]
    std::vector<CopiesGain> copies;        ///< gains by number of threads
    std::vector<std::string> differences;  ///< differences of hashes; must be empty
    double load_before = 0.0;              ///< the system's load average of the last minute; -1: unknown
    double load_after = 0.0;
    double calibrated = -1.0;  ///< smallest share of processors_requested() that calibrations before, amid and after got; -1: none

    /// Processors that the hungriest schedule kept busy, and how many it could have.
    [[nodiscard]] double processors_got() const noexcept;
    [[nodiscard]] int processors_requested() const noexcept;
    /// Whether it, or the calibration, got less than nine tenths: the benefit of threads cannot be measured on such a machine. (Waiting
    /// threads use processor time too, which only a calibration distinguishes.)
    [[nodiscard]] bool crowded() const noexcept;
};

/// @param progress called with one line before every part; may be empty
/// @throws as Simulation; SimulationError if the scene's run ends by itself
[[nodiscard]] Profile profile_schedules(const tasks::Scene& scene, const std::vector<tasks::Schedule>& schedules,
                                        const MeasureOptions& options, const std::function<void(const std::string&)>& progress = {});

}  // namespace cvtflow::bench
