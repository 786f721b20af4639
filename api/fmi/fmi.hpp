#pragma once
/// An instance of an FMU without the standard's types, and functions that both versions of the standard have; types of the Functional
/// Mock-up Interface, versions 2.0 and 3.0 (co-simulation); and a wall that no exception passes. A test compares the signatures with the
/// headers of the standard.

#include <cstddef>
#include <cstdint>
#include <cvtflow/simulation.hpp>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "api/host/entry.hpp"

#ifdef _WIN32
#define CVTFLOW_FMI extern "C" __declspec(dllexport)
#else
#define CVTFLOW_FMI extern "C" __attribute__((visibility("default")))
#endif

// Statuses of both versions agree as far as they are used here.
enum FmiStatus : int { fmi_ok = 0, fmi_warning = 1, fmi_discard = 2, fmi_error = 3, fmi_fatal = 4 };

namespace cvtflow::fmi {

enum class VariableKind { time, input, output, parameter, flag };

struct Variable {
    VariableKind kind = VariableKind::time;
    std::size_t width = 1;    ///< values
    std::size_t element = 0;  ///< the first of them in the channel
    std::string name;
};

/// Variables by value reference, as in the FMU's description: a text file in its resources, a line each, written by `cvtflow export-fmu`.
///
///     0 time 1 time
///     1 input 1 load_torque
///     5 output 24 links/tension        value reference, kind, values, name
///     29 output 1 links/tension 3      one element of a channel, counted from 0
///     40 parameter 1 tip.mass
///     41 flag 1 unreliable                 the only Boolean
using Variables = std::map<std::uint32_t, Variable>;

/// Everything that a later instance of the same FMU needs for a bitwise continuation.
struct Snapshot {
    std::map<std::string, double> parameters;  ///< parameters that differ from the scene's
    double start = 0.0, now = 0.0;             ///< communication points [s]
    bool ready = false;                        ///< the initialisation is over
    State state;

    [[nodiscard]] std::vector<std::byte> bytes() const;
    /// @throws Error (state)
    [[nodiscard]] static Snapshot from_bytes(std::span<const std::byte> bytes);
};

/// Called at output times inside a communication step with the time there [s]. @return whether the step shall end there
using Intermediate = std::function<bool(double)>;

class Instance {
public:
    /// @param resources folder of the FMU's resources. @throws Error
    explicit Instance(std::string resources);

    void set_start(double time);  ///< time [s]. @throws Error (argument)
    /// The start state with the parameters and inputs so far; settles it if parameters ask for that. @throws Error
    void finish_initialisation();
    void reset();

    /// All values of a variable, appended. @throws Error (argument) for an unknown reference, and for the flag
    void get(std::uint32_t reference, std::vector<double>& values);
    /// Value of the flag. @throws Error (argument) for other references
    [[nodiscard]] bool flag(std::uint32_t reference);
    /// value [unit of the variable]. @throws Error (argument) for outputs, and for parameters after the initialisation
    void set(std::uint32_t reference, double value);

    /// One communication step [s]; now() is then its end, or where `intermediate` ended it. @throws Error (argument) if it does not
    /// begin where the last one ended; faults, after which now() is the end of the last step
    void step(double begin, double length, const Intermediate& intermediate);

    [[nodiscard]] Snapshot snapshot();
    /// @throws Error (state); nothing has changed then
    void restore(const Snapshot& snapshot);
    /// Present time; inside a step, the time of the callback [s].
    [[nodiscard]] double now() const noexcept { return now_; }
    /// Whether the energy balance does not close, so that results are wrong.
    [[nodiscard]] bool unreliable() { return !simulation().energy().reliable; }
    /// Warnings, one line each.
    [[nodiscard]] std::vector<std::string> notices() { return simulation().notices(); }

private:
    [[nodiscard]] const Variable& variable(std::uint32_t reference) const;
    [[nodiscard]] Simulation& simulation();
    [[nodiscard]] Simulation made(const std::map<std::string, double>& parameters) const;
    void require_step(double begin, double length) const;
    [[nodiscard]] double number(const std::string& key) const;  ///< value of a key in the scene
    [[nodiscard]] double parameter(const std::string& key) const;

    std::string resources_;
    Variables variables_;
    Scene scene_;
    std::map<std::string, double> parameters_;
    std::optional<Simulation> simulation_;
    double start_ = 0.0, now_ = 0.0;  ///< [s]
    bool ready_ = false;
};

/// State of an instance in the standard's state machine.
enum class Stage { instantiated, initialising, stepping, in_step, terminated };

/// An instance as its importer holds it, with the function that writes to the importer's log.
struct Component {
    std::string name;
    bool logging = false;
    std::function<void(int status, const char* category, const char* message)> log;
    Instance instance;
    Stage stage = Stage::instantiated;
    std::vector<double> found;  ///< memory of get_values(), kept from call to call
    bool freed = false;         ///< a callback of the step under way has freed the instance

    Component(std::string called, bool logs, std::string resources)
        : name(std::move(called)), logging(logs), instance(std::move(resources)) {}
    virtual ~Component() = default;
    Component(const Component&) = delete;
    Component& operator=(const Component&) = delete;

    void say(int status, const char* category, const std::string& message) const {
        if (logging && log) log(status, category, message.c_str());
    }
    /// The stage goes with the state: one that was taken after the initialisation can be stepped from.
    void restore(const Snapshot& snapshot) {
        instance.restore(snapshot);
        if (snapshot.ready)
            stage = Stage::stepping;
        else if (stage > Stage::initialising)
            stage = Stage::initialising;
    }
};

[[nodiscard]] inline const char* stage_text(Stage stage) noexcept {
    switch (stage) {
        case Stage::instantiated: return "the initialisation has not begun";
        case Stage::initialising: return "the initialisation has not ended";
        case Stage::stepping: return "the initialisation has ended";
        case Stage::in_step: return "a step has not ended";
        default: return "the simulation was terminated";
    }
}

/// Status that an action returns; OK of one that returns nothing.
template <class Action>
int status_of(Action&& action, Component& self) {
    if constexpr (std::is_void_v<decltype(action(self))>) {
        action(self);
        return fmi_ok;
    } else {
        return action(self);
    }
}

/// Runs `action` on the component; whatever it throws becomes a line in the log and an error.
template <class Action>
int guarded(void* component, Action&& action) noexcept {
    if (component == nullptr) return fmi_error;
    auto& self = *static_cast<Component*>(component);
    try {
        return status_of(action, self);
    } catch (const std::exception& error) {
        try {
            self.say(fmi_error, "logStatusError", error.what());
        } catch (...) {}
        return fmi_error;
    } catch (...) {
        return fmi_error;
    }
}

/// A call that the standard allows in one stage only, and what follows it. The stage stays where `action` throws.
template <class Action>
int staged(void* component, const char* function, Stage from, Stage to, Action&& action) noexcept {
    return guarded(component, [&](Component& self) {
        if (self.stage != from) throw Error(ErrorCode::argument, std::string(function) + ": not allowed now: " + stage_text(self.stage));
        const int status = status_of(action, self);
        self.stage = to;
        return status;
    });
}

/// A call that the standard allows in every stage, but not in a callback of a step.
template <class Action>
int between_steps(void* component, const char* function, Action&& action) noexcept {
    return guarded(component, [&](Component& self) {
        if (self.stage == Stage::in_step)
            throw Error(ErrorCode::argument, std::string(function) + ": not allowed now: " + stage_text(self.stage));
        action(self);
    });
}

// Functions that both versions of the standard have, with arguments as the importer gives them, NULL included.

/// Frees the instance; in a callback of a step, at the end of that step.
void free_instance(void* component) noexcept;
int finish_initialisation(void* component) noexcept;
int terminate(void* component) noexcept;
int reset(void* component) noexcept;
int get_values(void* component, const std::uint32_t* references, std::size_t count, double* values, std::size_t room) noexcept;
/// Values of the Boolean variable. @tparam Flag  type of the standard's version: int or bool
template <class Flag>
int get_flags(void* component, const std::uint32_t* references, std::size_t count, Flag* values, std::size_t room) noexcept;
int set_values(void* component, const std::uint32_t* references, std::size_t count, const double* values, std::size_t number) noexcept;
int get_state(void* component, void** state) noexcept;
int set_state(void* component, const void* state) noexcept;
int free_state(void* component, void** state) noexcept;
int state_size(void* component, const void* state, std::size_t* size) noexcept;
int write_state(void* component, const void* state, void* bytes, std::size_t size) noexcept;
int read_state(void* component, const void* bytes, std::size_t size, void** state) noexcept;
int set_logging(void* component, bool on, std::size_t count, const char* const* categories) noexcept;
/// Instance::step(). @return a warning, with lines in the log, if the results have become unreliable in it, else OK
int advance(Component& self, double begin, double length, const Intermediate& intermediate);
/// Reports a function of the standard that this FMU does not offer.
int not_offered(void* component, const char* function) noexcept;

}  // namespace cvtflow::fmi
