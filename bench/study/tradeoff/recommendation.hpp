#pragma once
/// Recommendation for an accuracy among the choices on the front of error and time, and confirmation that a choice that is exact over a
/// short time is also right over a time long enough for slip and efficiency: bursts are rare.
///
/// Every choice to confirm runs from the scene's start over the same time. Its mean slip and its losses are compared with those of a
/// reference, its energy balance with itself (EnergyLedger), its step with the method's stable step at both ends of the reference
/// (predicted_step_limit()).

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/method/stability/linear_chain.hpp"
#include "bench/study/run_watch.hpp"
#include "engine/executor/cancellation.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/tuning/tuner.hpp"

namespace cvtflow::bench {

/// Index of the fastest point whose error is at most `error` / safety; empty if there is none.
[[nodiscard]] std::optional<std::size_t> recommended(const std::vector<tasks::TradeoffPoint>& points, double error, double safety);

/// An error measured on one scene is trusted on another within this factor.
inline constexpr double tradeoff_safety = 3.0;

struct ConfirmSettings {
    double duration = 20e-3;  ///< time from the scene's start [s]
    double interval = 12e-6;  ///< time between outputs [s]
    double tolerance = 0.01;  ///< tolerance of mean slip and losses
    std::vector<std::string>
        reference;  ///< settings; empty: the default method at a quarter of its automatic step, refined until it agrees with itself
};

/// A run long enough for means, or its fault.
struct LongRun {
    tasks::Fault fault;
    WatchResult watch;
    double step = 0.0;  ///< last one in use [s]
    double wall = 0.0;  ///< per simulated second [s/s]
};

struct Confirmed {
    bool ran = false;  ///< a step beyond stability is not tried
    LongRun run;
    double slip_error = 0.0, loss_error = 0.0;  ///< relative, against the reference
    std::string objection;                      ///< why it cannot be recommended, a few words; empty: nothing speaks against it
};

class Confirmation {
public:
    /// Runs the reference.
    /// @throws SimulationError if the start is not settled, the reference did not get through, its energy balance does not close, or it
    /// does not agree with itself
    Confirmation(tasks::Scene scene, ConfirmSettings settings, const engine::Cancellation& cancel);

    /// Up to which step the method is stable at both ends of the reference [s]; infinite: linear stability sets no limit. Settings as
    /// ErrorMeasure takes them.
    [[nodiscard]] double stable_step(std::span<const std::string> settings);
    /// Whether the step is longer than that; false for automatic steps and steps by error.
    [[nodiscard]] bool beyond_stability(std::span<const std::string> settings);
    [[nodiscard]] Confirmed check(std::span<const std::string> settings);
    /// The run alone, whatever its step.
    [[nodiscard]] LongRun run(std::span<const std::string> settings) const;
    /// Objections to it, without stability.
    [[nodiscard]] Confirmed judged(const LongRun& run) const;

    [[nodiscard]] const LongRun& reference() const noexcept { return reference_; }
    /// Which run that is, and how far one with twice the step is from it.
    [[nodiscard]] const std::string& reference_text() const noexcept { return reference_text_; }

private:
    [[nodiscard]] LongRun run(std::span<const std::string> settings, tasks::FrozenStart* begin, tasks::FrozenStart* end) const;
    void take_reference();
    void refine_reference();

    tasks::Scene scene_;
    ConfirmSettings settings_;
    const engine::Cancellation& cancel_;
    LongRun reference_;
    std::string reference_text_;
    std::unique_ptr<model::Variator> variator_;
    std::deque<bench::LinearChain> ends_;   ///< linearised at both ends of the reference
    std::map<std::string, double> stable_;  ///< stable step by method [s]
};

}  // namespace cvtflow::bench
