#pragma once
/// Methods with their steps on one scene: errors, cost, Newton's method, the axial force of a pin that enters the driving pulley, and which
/// of them are recommended: on the Pareto front of error and time, confirmed by longer runs.

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "bench/study/tradeoff/error_measure.hpp"
#include "bench/study/tradeoff/recommendation.hpp"
#include "tasks/tuning/tuner.hpp"
#include "tools/program/plot/plot.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace cvtflow::bench {

/// Result of --front for a choice.
struct FrontResult {
    double stable_step = 0.0;  ///< longest stable step of the method [s]; infinite: any
    std::optional<Confirmed> confirmed;
    std::string objection;  ///< reason against it, whatever its errors; empty: none
    bool front = false;

    /// "confirmed", the objection, or empty: not confirmed.
    [[nodiscard]] std::string outcome() const { return !objection.empty() ? objection : confirmed ? "confirmed" : ""; }
};

/// One choice of method and step.
struct ComparedChoice {
    std::string choice;                 ///< choice in the user's words: "rk4@50ns"
    std::vector<std::string> settings;  ///< settings of the scene that it means
    Trajectory run;                     ///< run of the last round
    TrajectoryErrors errors;
    double pin_error = std::numeric_limits<double>::quiet_NaN();  ///< error of the pin's axial force
    std::vector<double> seconds;                                  ///< wall time per simulated second, of each round
    FrontResult front_result;

    [[nodiscard]] double median() const;
    [[nodiscard]] double mean_step() const { return run.simulated / static_cast<double>(std::max(1L, run.counters.steps)); }
    /// Error in forces, infinite where there is an objection, and time.
    [[nodiscard]] tasks::TradeoffPoint point() const;
};

/// Settings of the measurement.
struct CompareSetting {
    std::string scene;
    std::string reference, duration, interval;  ///< options in the user's words
    WatchResult reference_watch;
    int rounds = 0;
    bool newton = false;            ///< columns of Newton's method
    std::optional<PinEntry> pin;    ///< pin whose force is compared
    bool front = false;             ///< whether there are columns and recommendations of the Pareto front, and the members below
    double confirm = 0.0;           ///< length of the long runs [s]
    std::string confirm_reference;  ///< Confirmation::reference_text()
    WatchResult confirm_watch;      ///< means of that reference
};

/// Target errors of the recommendations.
inline constexpr double recommended_errors[] = {1e-2, 1e-3, 1e-4, 1e-5};

[[nodiscard]] std::string compare_table(const std::vector<ComparedChoice>& choices, const CompareSetting& setting);
[[nodiscard]] std::string compare_csv(const std::vector<ComparedChoice>& choices, const CompareSetting& setting);
[[nodiscard]] std::string compare_json(const std::vector<ComparedChoice>& choices, const CompareSetting& setting);
[[nodiscard]] std::string recommendations(const std::vector<ComparedChoice>& choices, const CompareSetting& setting);
/// Error against time, without choices that have an objection.
[[nodiscard]] tools::Plot front_plot(const std::vector<ComparedChoice>& choices, const CompareSetting& setting);

/// Time since the start and the force on the sheave at -z, a column for the reference and for each choice that came to the end.
[[nodiscard]] std::string pin_csv(const std::vector<ComparedChoice>& choices, const Trajectory& reference, const CompareSetting& setting);
[[nodiscard]] tools::Plot pin_plot(const std::vector<ComparedChoice>& choices, const Trajectory& reference, const CompareSetting& setting);
/// Distance from the reference.
[[nodiscard]] tools::Plot pin_error_plot(const std::vector<ComparedChoice>& choices, const Trajectory& reference,
                                         const CompareSetting& setting);

struct FrontArguments {
    std::string confirm = "20 ms", reference;
};

/// --confirm, --confirm-against. @param front the option that they need
void declare_front(CLI::App& app, CLI::Option* front, FrontArguments& arguments);
/// interval [s]. @throws tasks::SceneError
[[nodiscard]] ConfirmSettings confirm_settings(const FrontArguments& arguments, double interval);
/// @throws tasks::SimulationError if the energy balance of the reference does not close
void require_reliable(const std::string& scene, const std::string& choice, const Trajectory& reference);

class ParetoFront {
public:
    /// Runs the reference of the confirmation. @throws as Confirmation
    ParetoFront(const tasks::Scene& scene, const ConfirmSettings& settings, const engine::Cancellation& cancel,
                std::function<void(const std::string&)> progress);

    /// Fills in the results of the choices, and the confirmation in the setting.
    void judge(std::vector<ComparedChoice>& choices, CompareSetting& setting);

private:
    void judge_steps(std::vector<ComparedChoice>& choices);

    const engine::Cancellation& cancel_;
    std::function<void(const std::string&)> progress_;
    double duration_;  ///< [s]
    Confirmation confirmation_;
};

}  // namespace cvtflow::bench
