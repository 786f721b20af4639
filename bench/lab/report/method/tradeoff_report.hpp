#pragma once
/// Cost and accuracy of choices of method and step, as text, CSV, JSON and picture.

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "bench/study/tradeoff/confirmation.hpp"
#include "bench/study/tradeoff/error_measure.hpp"
#include "tasks/tuning/pareto.hpp"

namespace cvtflow::bench {

/// One choice: its short rounds, and its long run if there was one.
struct TradeoffEntry {
    std::string choice;
    std::vector<std::string> settings;
    TrajectoryErrors errors;
    tasks::Fault fault;           ///< of the last short run
    tasks::RunVerdict watch;      ///< of the last short run
    double evaluations = 0.0;     ///< per simulated second
    std::vector<double> seconds;  ///< wall time per simulated second, of each round
    double stable_step = 0.0;     ///< up to which the method is stable [s]; infinite: any
    std::optional<Confirmed> confirmed;
    std::string objection;  ///< reason against it, whatever its errors; empty: none
    bool front = false;

    [[nodiscard]] double median() const;
    [[nodiscard]] double largest_force() const { return std::max(errors.axial_force, errors.tension); }
    /// "confirmed", the objection, or empty: not confirmed.
    [[nodiscard]] std::string standing() const;
    /// Whether there is an objection.
    [[nodiscard]] tasks::TradeoffPoint point() const;
};

/// Settings of the measurement.
struct TradeoffSetting {
    std::string scene;
    std::string reference, duration, interval;  ///< of the short runs, as given
    int rounds = 0;
    double confirm = 0.0;             ///< length of the long ones [s]
    std::string confirm_reference;    ///< Confirmation::reference_text()
    tasks::RunVerdict confirm_watch;  ///< of that run
};

/// Target errors of the recommendations.
inline constexpr double recommended_errors[] = {1e-2, 1e-3, 1e-4, 1e-5};

[[nodiscard]] std::string tradeoff_table(const std::vector<TradeoffEntry>& entries, const TradeoffSetting& setting);
[[nodiscard]] std::string tradeoff_recommendations(const std::vector<TradeoffEntry>& entries, const TradeoffSetting& setting);
[[nodiscard]] std::string tradeoff_csv(const std::vector<TradeoffEntry>& entries);
[[nodiscard]] std::string tradeoff_json(const std::vector<TradeoffEntry>& entries, const TradeoffSetting& setting);
/// Error against time as SVG, without choices that have an objection.
[[nodiscard]] std::string tradeoff_picture(const std::vector<TradeoffEntry>& entries, const TradeoffSetting& setting);

}  // namespace cvtflow::bench
