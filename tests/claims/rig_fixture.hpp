#pragma once
/// A variator on the test bench: the real step controller on a given state, without scene, file or settling.

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "model/start/start_state.hpp"
#include "tasks/schedule/integrator.hpp"
#include "tasks/step/control/step_controller.hpp"

namespace cvtflow::claims {

class Rig {
public:
    using Output = std::function<void(double time, const tasks::Workspace&)>;

    /// Begins with the given state and phases.
    Rig(const model::Parameters& parameters, const std::vector<double>& state, const std::vector<model::Phase>& phases, int segments = 1,
        std::string_view method = "rk4");
    /// Begins with the geometric start.
    explicit Rig(const model::Parameters& parameters, int segments = 1, std::string_view method = "rk4");

    /// Integrates; calls `output` at every output. Counters and transitions are those of the last run.
    tasks::Fault run(const tasks::StepSettings& settings, const Output& output = {});

    [[nodiscard]] tasks::Workspace& workspace() { return integrator_->workspace(); }
    [[nodiscard]] const model::Variator& variator() const { return integrator_->workspace().variator; }
    [[nodiscard]] const double* state() const { return integrator_->workspace().state(); }
    [[nodiscard]] std::vector<double> state_copy() const;
    [[nodiscard]] double* mutable_state() { return integrator_->workspace().state_to_set(); }
    [[nodiscard]] const std::vector<model::Phase>& phases() const { return integrator_->workspace().tips.phases; }
    [[nodiscard]] double time() const { return integrator_->workspace().step.time; }
    [[nodiscard]] const tasks::Counters& counters() const { return counters_; }
    [[nodiscard]] const std::vector<tasks::TransitionRecord>& transitions() const { return transitions_; }

private:
    std::unique_ptr<tasks::Integrator> integrator_;
    tasks::Counters counters_;
    std::vector<tasks::TransitionRecord> transitions_;
};

/// Names of all levels of detail: claims hold at every level.
[[nodiscard]] std::vector<std::string> levels();
/// The machine at a level of detail; pulleys that are absent stay so.
[[nodiscard]] model::Parameters at_level(model::Parameters parameters, const std::string& level);

/// No friction, no damping.
void make_conservative(model::Parameters& parameters);

/// A ring without pulleys that turns. speed [rad/s]
[[nodiscard]] model::Parameters free_ring(int pins, double speed = model::Start{}.ring_speed);
/// Gives every coordinate of the chain a different speed.
void jolt(const model::ChainLayout& at, double* state);

// Motions on which methods show their order.

/// A scene whose right-hand side is smooth along its motion: friction everywhere below saturation, so linear in speed; all else in contact.
struct Smooth {
    model::Parameters parameters;
    std::vector<double> state;
    std::vector<model::Phase> phases;
};

constexpr double smooth_span = 1.6e-6;  ///< s: a period of the fastest waves, too short for a tip to come or go

/// A free ring that turns fast, every coordinate at a different speed.
[[nodiscard]] Smooth disturbed_ring();
/// A ring around shaft 1, clamped between its elastic sheaves and turning: every tip deep in contact, none about to leave.
[[nodiscard]] Smooth clamped_ring();

/// Compares two states.
[[nodiscard]] double distance(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace cvtflow::claims
