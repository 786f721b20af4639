#pragma once
/// Scenes and simulations behind the handles of the C interface. Internal to api.

#include <cvtflow/cvtflow.h>
#include <cstdint>
#include <cvtflow/error.hpp>
#include <cvtflow/threads.hpp>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "api/host/entry.hpp"
#include "engine/executor/cancellation.hpp"
#include "engine/record/run/state_file.hpp"
#include "engine/thread/guards.hpp"
#include "model/observe/observation.hpp"
#include "model/start/start_state.hpp"
#include "tasks/channel/channels.hpp"
#include "tasks/run/saved_start.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow::api {

/// A scene, and what its simulations share.
struct SceneData {
    explicit SceneData(tasks::Scene from) : scene(std::move(from)) {}

    const tasks::Scene scene;

    /// Geometric start of its simulations, placed by the first one. @throws as model::start_state
    [[nodiscard]] const model::StartState& placed_start() const;
    /// Head of its states, written once.
    [[nodiscard]] const engine::StateHead& head() const;

private:
    mutable engine::Mutex mutex_;
    mutable std::optional<model::StartState> placed_start_;
    mutable std::optional<engine::StateHead> head_;
};

/// The channels that a simulation's machine has, and their present values.
class ChannelReader {
public:
    /// The simulation must outlive this.
    ChannelReader(const tasks::Simulation& simulation, const tasks::Scene& scene);

    [[nodiscard]] std::size_t size() const noexcept { return rows_.size(); }
    /// @throws Error (argument)
    [[nodiscard]] const tasks::Channel& row(std::size_t index) const;
    [[nodiscard]] std::size_t find(std::string_view name) const;    ///< @throws Error (argument)
    [[nodiscard]] std::span<const double> read(std::size_t index);  ///< @throws Error (argument)
    /// Discards the observation. Called after every change of the simulation.
    void changed() noexcept { observation_ = nullptr; }

private:
    const tasks::Simulation& simulation_;
    const int followed_pin_;
    model::Observer observer_;
    const model::Observation* observation_ = nullptr;  ///< observation of the present state; nullptr: none yet
    bool chain_observed_ = false;                      ///< the observation includes the chain
    std::vector<const tasks::Channel*> rows_;
    std::vector<std::vector<double>> values_;  ///< [channel][width]
};

/// Observer of a run: functions of the host that are called at outputs and transitions, and a recorder, if there is one.
class HostCallbacks final : public tasks::RunObserver {
public:
    /// @param interval between outputs of the scene [s]
    explicit HostCallbacks(double interval) : scene_interval_(interval) {}

    /// Times are present ones. An empty function removes the one before. now, interval [s]
    void on_output(double now, double interval, std::function<void()> callback);
    void on_transition(std::function<void(const cvtflow_transition&)> callback);
    /// The simulation has another state. now [s]
    void restart(double now);
    /// Time at which something may be due, at most `until`. now, until [s]
    [[nodiscard]] double next_stop(double now, double until) const noexcept;
    /// Calls back what has come due, in the host's floating-point environment. now [s]
    void deliver(double now, FloatingDefaults& defaults);

    void output(double time, const tasks::Workspace& workspace, const tasks::Counters& counters) override {
        if (recorder != nullptr) recorder->output(time, workspace, counters);
    }
    [[nodiscard]] bool samples(double time) const noexcept override { return recorder != nullptr && recorder->samples(time); }
    void sample(double time, const tasks::Workspace& workspace, const tasks::Counters& counters) override {
        recorder->sample(time, workspace, counters);
    }
    void transition(const tasks::TransitionRecord& record) override;
    /// Transitions since forget_pulled(). @param collects whether they are collected from now on
    [[nodiscard]] const std::vector<cvtflow_transition>& pull(bool collects) {
        pulls_ = collects;
        if (!collects) pulled_.clear();
        return pulled_;
    }
    void forget_pulled() noexcept { pulled_.clear(); }

    tasks::RunObserver* recorder = nullptr;

private:
    const double scene_interval_;                          ///< [s]
    std::shared_ptr<const std::function<void()>> output_;  ///< shared: a callback may replace itself
    double interval_ = 0.0;                                ///< [s]
    long outputs_ = 0;                                     ///< the next one is due at outputs_ * interval_
    std::shared_ptr<const std::function<void(const cvtflow_transition&)>> transition_;
    std::vector<cvtflow_transition> transitions_;  ///< transitions not delivered yet
    std::vector<cvtflow_transition> happened_;     ///< transitions in delivery
    std::vector<cvtflow_transition> pulled_;       ///< transitions that the host has not asked for yet
    bool pulls_ = false;                           ///< the host asks for transitions
};

/// @throws Error (argument) for a number of threads below min or above 1024
void require_threads(int count, int min);

/// Length of a step without transitions [s].
[[nodiscard]] double step_length(const tasks::Simulation& simulation, const tasks::Scene& scene);

/// A simulation of a host: alone, or on threads; calls of one thread at a time.
class HostSimulation final {
public:
    /// @param start replaces the start of the scene; nullptr: none
    HostSimulation(std::shared_ptr<const SceneData> scene, Threads threads, int segments, const model::StartState* start = nullptr);

    /// A stay inside the simulation: alone, or (for what callbacks may do) as the thread that is inside already.
    class Scope {
    public:
        enum class As { stepper, visitor };
        Scope(HostSimulation& of, As as);
        ~Scope();
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;

    private:
        HostSimulation& of_;
        bool entered_;
    };
    /// Result of `action` as a visitor, translated as by entered().
    template <class Action>
    decltype(auto) visited(Action&& action) {
        return entered(ErrorCode::internal, [&]() -> decltype(auto) {
            const Scope scope(*this, Scope::As::visitor);
            return action();
        });
    }

    /// One in the same state, without the callbacks.
    [[nodiscard]] std::unique_ptr<HostSimulation> copy();
    void advance(double until, long steps);  ///< until [s]
    void cancel() noexcept { cancel_.request(); }
    /// A state (engine/base/archive.hpp): head, integration.
    [[nodiscard]] std::vector<std::byte> state();
    /// Takes a state of the same scene, a checkpoint too. @throws Error (state)
    void restore(std::span<const std::byte> bytes);
    /// Fields of a state, whose mark, version and checksum are checked. @throws Error (state)
    static std::span<const std::byte> fields(std::span<const std::byte> bytes);
    /// Slope at (t [s], x), of the unknowns.
    void rhs(double t, const double* x, double* out);
    void hold(const model::HeldInputs& held);
    [[nodiscard]] std::vector<std::string> notices() const;
    [[nodiscard]] ChannelReader& channels() noexcept { return channels_; }
    [[nodiscard]] HostCallbacks& callbacks() noexcept { return callbacks_; }
    [[nodiscard]] const ChannelReader& channels() const noexcept { return channels_; }

    [[nodiscard]] const tasks::Scene& scene() const noexcept { return scene_->scene; }
    [[nodiscard]] const tasks::Simulation& simulation() const noexcept { return simulation_; }
    [[nodiscard]] std::size_t size() const noexcept { return static_cast<std::size_t>(simulation_.workspace().layout().size()); }

private:
    void take(tasks::IntegrationState state);
    void require_own_process();

    std::shared_ptr<const SceneData> scene_;
    Threads threads_;
    int segments_;
    tasks::Schedule schedule_;
    tasks::Simulation simulation_;
    std::optional<tasks::PlainSlope> slope_;  ///< slope for rhs(), from its first call on
    ChannelReader channels_;
    HostCallbacks callbacks_;
    std::vector<std::string> start_differences_;  ///< tasks::Simulation::start_differences() at the start of this one or what it copies
    engine::ReentryGuard entry_;
    engine::Cancellation cancel_;
    double last_stop_ = std::numeric_limits<double>::infinity();  ///< goal of the last advance(); infinity: one step, or none yet [s]
    long process_ = 0;                                            ///< process in which it first ran on threads; 0: none yet
};

/// Name, unit and meaning of an input; all live as long as the library is loaded and end in 0.
struct InputText {
    std::string_view name, unit, description;
};
/// @throws Error (argument) for a number that is no input
[[nodiscard]] InputText input_text(int input);
/// value [unit of the input] @throws Error (argument, busy)
void set_input(HostSimulation& simulation, int input, double value);
/// [unit of the input] @throws Error (argument)
[[nodiscard]] double input(const HostSimulation& simulation, int input);

}  // namespace cvtflow::api
