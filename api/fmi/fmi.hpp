#pragma once
/// Types of the Functional Mock-up Interface, versions 2.0 and 3.0 (co-simulation), as the standard has them, and a wall that no exception
/// passes. That signatures agree with the standard's own headers is a test.

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "api/fmi/instance.hpp"
#include "api/host/entry.hpp"

#ifdef _WIN32
#define CVTFLOW_FMI extern "C" __declspec(dllexport)
#else
#define CVTFLOW_FMI extern "C" __attribute__((visibility("default")))
#endif

// Statuses of both versions agree as far as they are used here.
enum FmiStatus : int { fmi_ok = 0, fmi_warning = 1, fmi_discard = 2, fmi_error = 3, fmi_fatal = 4 };

namespace cvtflow::fmi {

/// State of an instance in the standard's state machine.
enum class Stage { instantiated, initialising, stepping, in_step, terminated };

/// An instance as its importer holds it, with the function that writes to the importer's log.
struct Component {
    std::string name;
    bool logging = false;
    std::function<void(int status, const char* category, const char* message)> log;
    Instance instance;
    Stage stage = Stage::instantiated;
    std::vector<double> found;  ///< by get_values(), kept from call to call
    bool freed = false;         ///< by a callback of the step that has not ended

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

/// In a callback of a step: at the end of that step.
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
/// For functions of the standard that this FMU does not offer.
int not_offered(void* component, const char* function) noexcept;

}  // namespace cvtflow::fmi
