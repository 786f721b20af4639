#pragma once
/// Methods with their steps on one scene: errors of trajectories, cost, Newton's method, the axial force of a pin that enters the driving
/// pulley. Which choice is right in its means: cvtflow tune --all.

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "bench/lab/plot/plot.hpp"
#include "bench/study/error_measure.hpp"

namespace cvtflow::bench {

/// One choice of method and step.
struct ComparedChoice {
    std::string choice;                 ///< choice in the user's words: "rk4@50ns"
    std::vector<std::string> settings;  ///< settings of the scene that it means
    Trajectory run;                     ///< run of the last round
    TrajectoryErrors errors;
    double pin_error = std::numeric_limits<double>::quiet_NaN();  ///< error of the pin's axial force
    std::vector<double> seconds;                                  ///< wall time per simulated second, of each round

    [[nodiscard]] double median() const;
    [[nodiscard]] double mean_step() const { return run.simulated / static_cast<double>(std::max(1L, run.counters.steps)); }
};

/// Settings of the measurement.
struct CompareSetting {
    std::string scene;
    std::string reference, duration, interval;  ///< options in the user's words
    WatchResult reference_watch;
    int rounds = 0;
    bool newton = false;          ///< columns of Newton's method
    std::optional<PinEntry> pin;  ///< pin whose force is compared
};

[[nodiscard]] std::string compare_table(const std::vector<ComparedChoice>& choices, const CompareSetting& setting);
[[nodiscard]] std::string compare_csv(const std::vector<ComparedChoice>& choices, const CompareSetting& setting);
[[nodiscard]] std::string compare_json(const std::vector<ComparedChoice>& choices, const CompareSetting& setting);
/// Time since the start and the force on the sheave at -z, a column for the reference and for each choice that came to the end.
[[nodiscard]] std::string pin_csv(const std::vector<ComparedChoice>& choices, const Trajectory& reference, const CompareSetting& setting);
[[nodiscard]] tools::Plot pin_plot(const std::vector<ComparedChoice>& choices, const Trajectory& reference, const CompareSetting& setting);
/// Distance from the reference.
[[nodiscard]] tools::Plot pin_error_plot(const std::vector<ComparedChoice>& choices, const Trajectory& reference,
                                         const CompareSetting& setting);

}  // namespace cvtflow::bench
