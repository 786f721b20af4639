#pragma once
/// Implementation of the public Simulation. Internal to api.

#include <cvtflow/simulation.hpp>
#include <limits>
#include <optional>

#include "api/host/entry.hpp"
#include "api/host/state_bytes.hpp"
#include "api/scene_data.hpp"
#include "engine/executor/cancellation.hpp"
#include "engine/thread/guards.hpp"
#include "model/observe/observation.hpp"
#include "tasks/channel/channels.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow {
inline namespace v0 {

class Simulation::Impl final : private tasks::RunObserver {
public:
    using StateRecord = api::StateRecord;

    /// @param start to begin in, instead of the scene's; nullptr: the scene's
    Impl(const Scene& scene, Threads threads, int segments, const model::StartState* start = nullptr);

    /// A stay inside the simulation: alone, or (for what callbacks may do) as the thread that is inside already.
    class Scope {
    public:
        enum class As { stepper, visitor };
        Scope(Impl& impl, As as);
        ~Scope();
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;

    private:
        Impl& impl_;
        bool entered_;
    };

    /// Frees a simulation, or leaves that to the call under way if its callback does this.
    static void end(std::unique_ptr<Impl> impl) noexcept;
    /// Into another object.
    void moved() noexcept { abandoned_ |= entry_.mine(); }
    [[nodiscard]] std::unique_ptr<Impl> copy();
    void advance(Simulation& self, double until, long steps);  ///< until [s]
    void cancel() noexcept { cancel_.request(); }
    [[nodiscard]] std::vector<std::byte> state_bytes() const;
    void restore(StateRecord record);
    void set_input(Input input, double value);  ///< value [unit of the input]
    [[nodiscard]] double input(Input input) const;
    void rhs(double t, std::span<const double> x, std::span<double> out);  ///< t [s], x [unknowns], out [unknowns, per second]
    [[nodiscard]] std::span<const double> channel(std::size_t index);
    [[nodiscard]] const tasks::Channel& channel_row(std::size_t index) const;
    [[nodiscard]] std::size_t find_channel(std::string_view name) const;
    void on_output(double interval, std::function<void(Simulation&)> callback);  ///< interval [s]
    void on_transition(std::function<void(Simulation&, const Transition&)> callback);
    [[nodiscard]] std::vector<std::string> notices() const;
    [[nodiscard]] Energy energy() const noexcept;
    [[nodiscard]] double largest_stable_step();

    /// Observer of outputs and transitions; nullptr: none.
    [[nodiscard]] tasks::RunObserver*& recorder() noexcept { return recorder_; }

    [[nodiscard]] const Scene& scene() const noexcept { return scene_; }
    [[nodiscard]] const tasks::Simulation& simulation() const noexcept { return simulation_; }
    [[nodiscard]] std::size_t channels() const noexcept { return channels_.size(); }
    [[nodiscard]] double step_length() const noexcept;
    [[nodiscard]] Counters counters() const noexcept;

private:
    void output(double time, const tasks::Workspace& workspace, const tasks::Counters& counters) override {
        if (recorder_ != nullptr) recorder_->output(time, workspace, counters);
    }
    void transition(const tasks::TransitionRecord& record) override;
    [[nodiscard]] const tasks::Scene& data() const noexcept { return scene_.data_->scene; }
    void require_own_process();
    [[nodiscard]] double next_stop(double until) const;   ///< until [s]
    [[nodiscard]] double earliest_stop() const noexcept;  ///< that advance() accepts [s]
    void require_owner() const;
    void deliver(Simulation& self, api::FloatingDefaults& defaults);
    [[nodiscard]] std::string advice(tasks::FaultKind kind) const;
    void hold(const model::HeldInputs& held);

    Scene scene_;
    Threads threads_;
    int segments_;
    tasks::Schedule schedule_;
    tasks::Simulation simulation_;
    std::optional<tasks::PlainSlope> slope_;  ///< of rhs(), from its first call on
    model::Observer observer_;
    const model::Observation* observation_ = nullptr;  ///< of the present state; nullptr: not made yet
    bool chain_observed_ = false;                      ///< it is not of the shafts alone
    std::vector<std::string> start_differences_;  ///< tasks::Simulation::start_differences() at the start of this one or what it copies
    std::vector<const tasks::Channel*> channels_;
    std::vector<std::vector<double>> values_;  ///< [channel][width]
    engine::ReentryGuard entry_;
    engine::Cancellation cancel_;
    bool abandoned_ = false;  ///< the object that calls back was destroyed or moved by its callback
    bool ended_ = false;      ///< to be freed by the call under way
    double last_stop_ =
        std::numeric_limits<double>::infinity();  ///< of the last advance(); infinity: it took one step, or there was none [s]
    long process_ = 0;                            ///< in which it first ran on threads; 0: it has not
    std::shared_ptr<const std::function<void(Simulation&)>> output_callback_;  ///< shared: a callback may replace itself
    double output_interval_ = 0.0;                                             ///< [s]
    long outputs_ = 0;                                                         ///< the next one is due at outputs_ * output_interval_
    std::shared_ptr<const std::function<void(Simulation&, const Transition&)>> transition_callback_;
    std::vector<Transition> transitions_;  ///< not delivered yet
    std::vector<Transition> happened_;     ///< being delivered
    tasks::RunObserver* recorder_ = nullptr;
};

}  // namespace v0
}  // namespace cvtflow
