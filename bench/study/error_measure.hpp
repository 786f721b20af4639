#pragma once
/// Cost of a run and its error against a run with a tight step: the two axes of every work-precision picture.
/// A run is a scene and settings ("run.method=dumka3-p5", "run.step=2us", …), independent of the kind of method.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/method/implicit/trapezoidal.hpp"
#include "bench/study/run_watch.hpp"
#include "engine/record/run/state_file.hpp"
#include "tasks/run/simulation.hpp"

namespace cvtflow::bench {

/// The one definition of a relative error: ‖is - expected‖/‖expected‖, Euclidean, over all numbers that are added. All errors of methods in
/// the documents use it.
class RelativeError {
public:
    /// Adds numbers of one instant or quantity, in any unit. @param is, expected equally long
    void add(std::span<const double> is, std::span<const double> expected) noexcept;
    /// Adds the sums of another one.
    void add(const RelativeError& other) noexcept;

    /// 0 if both are zero; infinite where a number is not finite, or differs from a reference of zeros.
    [[nodiscard]] double value() const noexcept;

private:
    double difference_ = 0.0, reference_ = 0.0;  ///< sums of squares
};

[[nodiscard]] double relative_error(std::span<const double> is, std::span<const double> expected) noexcept;

/// Data whose errors are measured, at the output times of one run; the start is not among them.
struct Trajectory {
    std::vector<double> times;                     ///< [outputs] [s]
    std::vector<std::vector<double>> axial_force;  ///< [outputs][4 links] axial force of each tip [N]
    std::vector<std::vector<double>> tension;      ///< [outputs][links] [N]
    std::vector<double> slip;                      ///< [outputs] slip of both pulleys together
    std::vector<double> losses;                    ///< [outputs] power turned into heat [W]
    std::vector<tasks::TransitionRecord> transitions;
    std::vector<double> side;                       ///< [links] x of the rear halves at the start [m]
    std::optional<bench::NewtonStatistics> newton;  ///< statistics of trapezoidal methods

    tasks::Counters counters;
    tasks::Fault fault;        ///< reason for an early end, if any
    double step = 0.0;         ///< longest step used [s]
    double simulated = 0.0;    ///< [s]
    double wall = 0.0;         ///< wall time without observing [s]
    double steady_wall = 0.0;  ///< wall time per simulated second of a longer run; 0: the short run is representative [s/s]
    WatchResult watch;         ///< whether its figures can be right
    std::uint64_t hash = 0;
    std::string schedule;

    [[nodiscard]] double evaluations_per_second() const noexcept { return static_cast<double>(counters.evaluations) / simulated; }
    [[nodiscard]] double wall_per_second() const noexcept { return steady_wall > 0.0 ? steady_wall : wall / simulated; }
    /// Axial force of a pin on the sheave at that side (0: -z, 1: +z): of its rear half and of the front half before it. [outputs] [N]
    [[nodiscard]] std::vector<double> pin_axial(int pin, int sheave_side) const;
};

/// A pin that comes to touch a sheave of the driving shaft.
struct PinEntry {
    int pin = 0;
    double time = 0.0;  ///< [s]
};

/// The first one; nothing if none enters.
[[nodiscard]] std::optional<PinEntry> first_entry(const Trajectory& run, const model::Parameters& parameters);
/// ‖axial force of a pin on both sheaves - reference‖/‖reference‖; infinite for a run that ended early [1]
[[nodiscard]] double pin_error(const Trajectory& run, const Trajectory& reference, int pin);

/// Relative errors: ‖x - reference‖/‖reference‖, Euclidean.
struct TrajectoryErrors {
    double axial_force = 0.0;  ///< [1]
    double tension = 0.0;      ///< [1]
    double slip = 0.0;         ///< [1]
    double losses = 0.0;       ///< [1]

    [[nodiscard]] double largest() const noexcept;
};

/// Over all outputs together, and of the worst output alone. A run that ended early or holds no finite number has infinite errors.
struct ErrorReport {
    TrajectoryErrors overall, worst;
};

/// Errors of a run against another one with the same output times.
/// @throws std::invalid_argument if the reference ended early or its output times differ
[[nodiscard]] ErrorReport compare(const Trajectory& run, const Trajectory& reference);

/// Where and how often runs are observed. The default interval is a multiple of 1, 1.5, 2, 3, 4 and 6 us: such steps are used unchanged.
struct MeasureSettings {
    double duration = 120e-6;                                                 ///< time from the scene's start [s]
    double interval = 12e-6;                                                  ///< time between outputs [s]
    std::vector<std::string> reference{"run.method=rk4", "run.step=12.5ns"};  ///< settings of the reference
    /// Automatic steps estimate the spectrum often in the beginning: their cost is measured over this, if it is longer than `duration` [s].
    double steady = 4e-3;
    std::optional<engine::SavedState> start = {};  ///< where runs begin; nothing: the scene's state file
};

/// The scene with outputs and states every `interval` [s], then with `settings` (key=value), which may overrule them.
/// @throws SceneError
[[nodiscard]] tasks::Scene with_outputs(const tasks::Scene& scene, double interval, std::span<const std::string> settings);

class ErrorMeasure {
public:
    /// Runs the reference.
    /// @throws SimulationError if the scene's start is not settled or the reference did not get through; others as Simulation and
    /// set_values
    ErrorMeasure(tasks::Scene scene, MeasureSettings settings, const engine::Cancellation& cancel);

    /// Runs the scene with these settings, like the reference. A run that fails is a result: see Trajectory::fault.
    /// @throws as set_values and Simulation
    [[nodiscard]] Trajectory run(std::span<const std::string> settings) const;

    [[nodiscard]] const Trajectory& reference() const noexcept { return reference_; }
    [[nodiscard]] ErrorReport errors(const Trajectory& run) const { return compare(run, reference_); }

private:
    tasks::Scene scene_;
    MeasureSettings settings_;
    const engine::Cancellation& cancel_;
    Trajectory reference_;
};

}  // namespace cvtflow::bench
