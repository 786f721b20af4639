#pragma once
/// Everything that a profile of a scene's schedules measures, in the order in which it is measured.

#include <functional>

#include "tasks/profile/measure.hpp"
#include "tasks/profile/model.hpp"

namespace cvtflow::tasks {

/// Which schedules are compared.
struct ScheduleChoice {
    std::vector<std::string> names{};   ///< "executor" (the scene's assembly) or "executor:fused", "executor:staged"; none: all executors x both
    std::vector<int> threads{};         ///< none: as many as are usable
    std::vector<int> segments{};        ///< 0: as many as threads; none: 0
};

/// The schedules of a choice, serial:fused with one segment first, none twice. Executors of one thread appear once per assembly.
/// @throws SceneError for an executor or assembly that does not exist, or more segments than links
[[nodiscard]] std::vector<Schedule> chosen_schedules(const Scene& scene, const ScheduleChoice& choice);

/// Synchronisation of `flow` with two threads on a quiet machine [s]: what the model takes where it cannot be measured.
inline constexpr double assumed_synchronisation = 0.3e-6;

struct ProfileModel {
    PathCosts costs;
    double serial_share = 0.0;             ///< of the serial fused run
    std::vector<bool> touching;            ///< [links]
    std::vector<ThreadCost> synchronisation;   ///< cycles of the `flow` executor on which all threads came
    bool assumed = false;                  ///< no such cycle with more than one thread: the synchronisation is `assumed_synchronisation`
    std::vector<SpeedUpRow> curves;
};

struct Profile {
    std::vector<ScheduleResult> results;   ///< the first is serial:fused
    std::vector<ThreadCost> bare;          ///< bare barrier by number of threads [s per cycle]
    ProfileModel model;
    std::vector<std::string> differences;  ///< in hashes; must be empty
    double load_before = 0.0;              ///< the system's load average of the last minute; -1: unknown
    double load_after = 0.0;

    /// Processors that the hungriest schedule kept busy, and how many it could have.
    [[nodiscard]] double processors_got() const noexcept;
    [[nodiscard]] int processors_wanted() const noexcept;
    /// Whether it got less than nine tenths: what threads bring cannot be seen on such a machine. (Waiting threads burn time too.)
    [[nodiscard]] bool crowded() const noexcept { return processors_got() < 0.9 * processors_wanted(); }
};

/// @param progress called with one line before every part; may be empty
/// @throws as Simulation; SimulationError if the scene's run ends by itself
[[nodiscard]] Profile profile_schedules(const Scene& scene, const std::vector<Schedule>& schedules, const MeasureOptions& options,
                                        const std::function<void(const std::string&)>& progress = {});

/// Costs of links from recorded serial runs with two numbers of segments, of detection and controller beside; of the synchronisation from
/// cycles of `flow` on 1, 2, 4 … threads, up to the usable ones.
[[nodiscard]] ProfileModel measure_model(const Scene& scene, const Recording& serial, const MeasureOptions& options);

}  // namespace cvtflow::tasks
