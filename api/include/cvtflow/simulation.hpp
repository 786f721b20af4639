#pragma once
/// One simulation of one scene inside a host program.
///
/// Threads. A simulation is used by one thread at a time, of any identity. Any number of simulations may run side by side on any threads,
/// they share nothing. cancel() may be called from any thread and from signal handlers. A second call while one is under way is refused
/// (busy), it neither waits nor breaks anything.
///
/// Callbacks run on the thread that called advance_to(), between steps, outside of any parallel section: they may read the simulation, set
/// its inputs, cancel it, use other simulations in every way, and throw (the exception leaves advance_to()). Stepping or replacing the
/// state of the simulation that runs the callback is refused (busy). A callback that destroys or moves its simulation ends advance_to()
/// (cancelled) without further callbacks; the memory of a destroyed one is freed when advance_to() ends. A callback must not end its thread
/// (pthread_exit), since nothing unwinds through C.
///
/// Floating-point environment. Everything (scenes read, simulations made, steps, questions) runs in the default environment (round to
/// nearest, denormals kept, traps off), whatever the host has set, so results do not depend on it; the host's is put back for callbacks and
/// on return.

#include <cvtflow/error.hpp>
#include <cvtflow/scene.hpp>
#include <cvtflow/threads.hpp>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace cvtflow {
inline namespace v0_4 {

/// Inputs that a host may set between steps. A set value replaces the scene's table from then on. A far end turns on from its present angle
/// with the speed that is set; setting its angle as well keeps a host's sum of angles and the simulation's together.
enum class Input : int {
    clamping_driving = 0,  ///< S_1 [N], ≥ 0; not with hydraulics.mode = "pressure"
    clamping_driven = 1,   ///< S_2 [N], ≥ 0; not with hydraulics.mode = "pressure"
    load_torque = 2,       ///< torque against the travel of shaft 2, load.mode = "torque" [N·m]
    drive_torque = 3,      ///< torque on shaft 1, drive.mode = "torque" [N·m]
    drive_speed = 4,       ///< speed of shaft 1, drive.mode = "speed", or of the far end, "coupling" [rad/s]
    ratio = 5,             ///< target speed ratio, with control.enabled
    load_speed = 6,        ///< speed of shaft 2, load.mode = "speed", or of the far end, "coupling" [rad/s]
    load_angle = 7,        ///< angle of the far end since t = 0, load.mode = "coupling" [rad]
    drive_angle = 8,       ///< angle of the far end since t = 0, drive.mode = "coupling" [rad]
    pressure_driving = 9,  ///< target of the driving valve, hydraulics.mode = "pressure" [Pa]
    pressure_driven = 10,  ///< target of the driven valve, hydraulics.mode = "pressure" [Pa]
};

struct InputInfo {
    std::string_view name;  ///< name of the enumerator: "load_torque"; all three live as long as the library is loaded and end in 0
    std::string_view unit;  ///< "N*m", "1" for none
    std::string_view description;
};

/// @throws Error (argument) for a number that is no input: they are numbered from 0 without a gap
[[nodiscard]] inline InputInfo input_info(Input input) {
    cvtflow_channel_info info{sizeof info, 0, "", "", "", 1};
    detail::call(cvtflow_input_describe, static_cast<std::int32_t>(input), &info);
    return {info.name, info.unit, info.description};
}

/// Counters since the start; after settling, since t = 0. Part of the state.
struct Counters {
    std::int64_t steps = 0;        ///< accepted steps, truncated ones included
    std::int64_t evaluations = 0;  ///< evaluations of the right-hand side
    std::int64_t transitions = 0;  ///< changes of a tip's phase
    std::int64_t truncated = 0;    ///< steps cut at a transition
    std::int64_t suppressed = 0;   ///< transitions postponed because the tip had just changed
    bool operator==(const Counters&) const = default;
};

/// Energy balance, and whether results are reliable since the start (after settling, since t = 0).
struct Energy {
    double residual = 0.0;    ///< change of the stored energy - work of the inputs + losses [J]
    double dissipated = 0.0;  ///< [J]
    /// |residual| over its tolerance: the largest of settling, of windows of 2 ms and of the whole run
    double error_ratio = 0.0;
    bool reliable = true;  ///< error_ratio ≤ 1; else results are wrong: use a shorter step, or run.step = "auto"
    bool operator==(const Energy&) const = default;
};

struct ChannelInfo {
    std::string_view name;  ///< "shaft_1/torque"; all three live as long as the library is loaded and end in 0
    std::string_view unit;  ///< "N*m", "1" for none
    std::string_view description;
    std::size_t width = 1;  ///< number of values
};

/// A change of a tip's phase. Phases: 0 free, 1 touching, 2 sticking, 3 slipping.
struct Transition {
    double time;  ///< [s]
    int pin;      ///< counted from 0
    int tip;      ///< 4 link + 2 (front half) + (side +z)
    int from, to;
};

/// The full integration state: set_state(state()) continues bitwise. Inputs that the host has set are part of it.
class State {
public:
    State() = default;
    /// @throws Error (state) if the bytes are damaged or of another version
    [[nodiscard]] static State from_bytes(std::span<const std::byte> bytes) {
        detail::call(cvtflow_state_check, static_cast<const void*>(bytes.data()), bytes.size());
        State state;
        state.bytes_.assign(bytes.begin(), bytes.end());
        return state;
    }
    [[nodiscard]] std::span<const std::byte> bytes() const noexcept { return bytes_; }
    bool operator==(const State&) const = default;

private:
    friend class Simulation;
    std::vector<std::byte> bytes_;
};

class Simulation {
public:
    /// Prepares the start state. Starts no thread. @param segments tasks per step; 0: one per thread
    /// @throws Error (start_state, scene, argument)
    explicit Simulation(const Scene& scene, Threads threads = Threads::caller(), int segments = 0) : Simulation(scene, nullptr) {
        cvtflow_options options{sizeof options, static_cast<std::int32_t>(threads.way()), threads.count(), segments};
        detail::call(cvtflow_create, scene.get(), const_cast<const cvtflow_options*>(&options), &held_->handle);
    }
    ~Simulation() { end(std::move(held_)); }
    Simulation(Simulation&& other) noexcept : held_(std::move(other.held_)) { move_here(); }
    Simulation& operator=(Simulation&& other) noexcept {
        if (this == &other) return *this;
        end(std::exchange(held_, std::move(other.held_)));
        move_here();
        return *this;
    }
    Simulation(const Simulation&) = delete;
    Simulation& operator=(const Simulation&) = delete;
    /// A second simulation of the same scene in the same state, without the callbacks. @throws Error (busy, memory)
    [[nodiscard]] Simulation copy() const {
        Simulation other(scene(), nullptr);
        detail::call(cvtflow_copy, get(), &other.held_->handle);
        return other;
    }

    [[nodiscard]] const Scene& scene() const noexcept { return held_->scene; }
    /// The handle of C, which lives as long as this.
    [[nodiscard]] cvtflow_simulation* get() const noexcept { return held_->handle; }
    /// [s]. A geometric start that has to settle begins at -start.settling_time: advance_to(0) settles it.
    [[nodiscard]] double time() const noexcept { return cvtflow_time(get()); }
    /// The method of its steps, never "auto": what run.method = "auto" is with this scene.
    [[nodiscard]] std::string method() const { return cvtflow_method(get()); }
    /// Length of a step without transitions [s].
    [[nodiscard]] double step_length() const noexcept { return cvtflow_step_length(get()); }

    /// Takes whole steps until time() ≥ t. Where the calls end does not change the result: one call or a thousand give the same bits.
    /// A time before the last one, or more than a step before time(), is refused: states go back, steps do not.
    /// @param t [s]
    /// @throws Error (a fault, cancelled, busy, forked, argument); the state is then that of the last accepted step
    void advance_to(double t) {
        run([t](cvtflow_simulation* s, cvtflow_message* message) { return cvtflow_advance_to(s, t, message); });
    }
    /// One step, which a transition may shorten. @throws as advance_to
    void step() { run(cvtflow_step); }
    /// Ends advance_to() of another thread after at most one step, or the next call at its beginning. One request ends one call.
    void cancel() noexcept { cvtflow_cancel(get()); }

    [[nodiscard]] State state() const {
        State state;
        for (std::size_t size = 0;; state.bytes_.resize(size)) {
            detail::call(cvtflow_state_get, get(), state.bytes_.empty() ? nullptr : static_cast<void*>(state.bytes_.data()), &size);
            if (size == state.bytes_.size()) return state;
        }
    }
    /// @throws Error (state) if it is of another scene, busy
    void set_state(const State& state) {
        detail::call(cvtflow_state_set, get(), static_cast<const void*>(state.bytes_.data()), state.bytes_.size());
    }
    /// Hash of unknowns and phases: bitwise equality in short.
    [[nodiscard]] std::uint64_t hash() const { return cvtflow_hash(get()); }

    /// @param value [unit of the input]   @throws Error (argument) for a value out of range or an input that the scene does not have; busy
    void set_input(Input input, double value) { detail::call(cvtflow_input_set, get(), static_cast<std::int32_t>(input), value); }
    /// Present value, set or of the scene's table. @throws Error (argument) as above
    [[nodiscard]] double input(Input input) const {
        double value = 0.0;
        detail::call(cvtflow_input_get, get(), static_cast<std::int32_t>(input), &value);
        return value;
    }

    /// Number of unknowns: coordinates and velocities link by link, then shafts and sheaves (ARCHITECTURE.md).
    [[nodiscard]] std::size_t size() const noexcept { return cvtflow_size(get()); }
    /// The unknowns now [size()]; valid until the next step.
    [[nodiscard]] std::span<const double> unknowns() const noexcept { return {cvtflow_unknowns(get()), size()}; }
    /// out = dx/dt at (t, x), for solvers of the host: a function of t and x alone (a tip that penetrates touches, any other is free)
    /// and of the inputs. Uses the simulation's memory: not from two threads at once. @throws Error (argument) for lengths, busy
    void rhs(double t, std::span<const double> x, std::span<double> out) {
        if (x.size() != out.size()) throw Error(ErrorCode::argument, "rhs: spans of different lengths");
        detail::call(cvtflow_rhs, get(), t, x.data(), out.data(), x.size());
    }

    [[nodiscard]] std::size_t channels() const noexcept { return cvtflow_channel_count(get()); }
    /// @throws Error (argument)
    [[nodiscard]] ChannelInfo channel_info(std::size_t index) const {
        cvtflow_channel_info info{sizeof info, 0, "", "", "", 1};
        detail::call(cvtflow_channel_describe, get(), index, &info);
        return {info.name, info.unit, info.description, info.width};
    }
    /// @throws Error (argument) with the name that was probably meant
    [[nodiscard]] std::size_t find_channel(const std::string& name) const {
        std::size_t index = 0;
        detail::call(cvtflow_channel_find, get(), name.c_str(), &index);
        return index;
    }
    /// The values of a channel now. Their place stays while the simulation lives, the numbers there change with the next read. The first
    /// read after a step observes the whole state, some tens of microseconds; further reads are free. @throws Error (argument)
    [[nodiscard]] std::span<const double> channel(std::size_t index) {
        const double* values = nullptr;
        std::size_t width = 0;
        detail::call(cvtflow_channel_values, get(), index, &values, &width);
        return {values, width};
    }
    [[nodiscard]] std::span<const double> channel(const std::string& name) { return channel(find_channel(name)); }

    [[nodiscard]] Counters counters() const noexcept {
        cvtflow_counters now{sizeof now, 0, 0, 0, 0, 0, 0};
        cvtflow_counters_get(get(), &now);
        return {now.steps, now.evaluations, now.transitions, now.truncated, now.suppressed};
    }
    [[nodiscard]] Energy energy() const noexcept {
        cvtflow_energy now{sizeof now, 0, 0.0, 0.0, 0.0};
        cvtflow_energy_get(get(), &now);
        return {now.residual, now.dissipated, now.error_ratio, now.reliable != 0};
    }
    /// Warnings, one line each: differences between the scene and the one that its state file was settled with; keys without effect; an
    /// energy balance that does not close; fewer threads than requested (simulations of this process then run on fewer, down to the caller
    /// alone, with the same bits).
    [[nodiscard]] std::vector<std::string> notices() const {
        std::vector<std::string> lines;
        const cvtflow_log_function add = [](const char* line, void* to) { static_cast<std::vector<std::string>*>(to)->emplace_back(line); };
        detail::call(cvtflow_notices, get(), add, static_cast<void*>(&lines));
        return lines;
    }
    /// Longest step with which the scene's method is linearly stable here, chain, pulleys and control alike: some tenths of a second of
    /// work for leapfrogs and short tables, more for many stages. Infinite if linear stability sets no limit [s].
    /// @throws Error busy
    [[nodiscard]] double largest_stable_step() {
        double step = 0.0;
        detail::call(cvtflow_largest_stable_step, get(), &step);
        return step;
    }

    /// Called after the first step at or after every multiple of `interval` [s]. Replaces the one before; an empty function removes it.
    /// @throws Error (argument) unless interval > 0; busy
    void on_output(double interval, std::function<void(Simulation&)> callback) {
        detail::call(cvtflow_on_output, get(), interval, callback ? &Held::output : nullptr, static_cast<void*>(held_.get()));
        held_->on_output = std::make_shared<const std::function<void(Simulation&)>>(std::move(callback));
    }
    /// Called for every transition since the last call, in their order, between two outputs at the latest. At rigid pins tips touch or are
    /// free, from the end of a step on. @throws Error busy
    void on_transition(std::function<void(Simulation&, const Transition&)> callback) {
        detail::call(cvtflow_on_transition, get(), callback ? &Held::transition : nullptr, static_cast<void*>(held_.get()));
        held_->on_transition = std::make_shared<const std::function<void(Simulation&, const Transition&)>>(std::move(callback));
    }

private:
    friend class Recording;

    /// What callbacks are called with: it stays where it is when the Simulation moves, and until the call under way ends.
    struct Held {
        explicit Held(Scene of) : scene(std::move(of)) {}

        /// Runs a callback, which may replace itself. No exception passes through C: it waits until the function of C has returned.
        template <class Callback>
        int call_back(const std::shared_ptr<const Callback>& callback, auto&&... arguments) noexcept {
            Simulation* const before = self;
            try {
                const auto kept = callback;
                (*kept)(*before, arguments...);
            } catch (...) {
                thrown = std::current_exception();
                return 1;
            }
            return self != before ? 1 : 0;  // moved, or destroyed
        }
        static int output(cvtflow_simulation*, void* user) noexcept {
            auto& held = *static_cast<Held*>(user);
            return held.call_back(held.on_output);
        }
        static int transition(cvtflow_simulation*, const cvtflow_transition* now, void* user) noexcept {
            auto& held = *static_cast<Held*>(user);
            return held.call_back(held.on_transition, Transition{now->time, now->pin, now->tip, now->from, now->to});
        }

        Scene scene;
        cvtflow_simulation* handle = nullptr;
        Simulation* self = nullptr;  ///< its present place
        std::shared_ptr<const std::function<void(Simulation&)>> on_output{};
        std::shared_ptr<const std::function<void(Simulation&, const Transition&)>> on_transition{};
        std::exception_ptr thrown{};
    };

    Simulation(const Scene& scene, std::nullptr_t) : held_(std::make_shared<Held>(scene)) { move_here(); }

    template <class Action>
    void run(Action action) {
        const std::shared_ptr<Held> kept = held_;  // a callback may destroy this
        detail::Message message;
        const cvtflow_code code = action(kept->handle, message.get());
        if (kept->thrown) std::rethrow_exception(std::exchange(kept->thrown, nullptr));
        if (code == CVTFLOW_CALLBACK) throw Error(ErrorCode::cancelled, "the simulation was destroyed or moved by its own callback");
        message.check(code);
    }
    void move_here() noexcept {
        if (held_) held_->self = this;
    }
    static void end(std::shared_ptr<Held> held) noexcept {
        if (!held) return;
        held->self = nullptr;
        cvtflow_destroy(std::exchange(held->handle, nullptr));
    }

    std::shared_ptr<Held> held_;
};

/// Ends the worker threads that simulations of this process have started, and waits until they are gone: before dlclose(), or where a host
/// counts threads. To be called while no simulation steps; later steps start new ones. Not in the core library.
/// @return false if other users of oneTBB in this process keep its threads alive (or a simulation is still stepping)
inline bool shutdown() noexcept { return cvtflow_shutdown() == CVTFLOW_OK; }

}  // namespace v0_4
}  // namespace cvtflow
