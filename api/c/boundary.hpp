#pragma once
/// Boundary of C: handles, and a wall that no exception passes. Internal to api.

#include <cvtflow/cvtflow.h>

#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "api/host/entry.hpp"
#include "api/simulation_impl.hpp"
#include "engine/thread/guards.hpp"

struct cvtflow_scene {
    std::shared_ptr<const cvtflow::api::SceneData> data;

    [[nodiscard]] const cvtflow::tasks::Scene& scene() const noexcept { return data->scene; }
};

struct cvtflow_simulation {
    std::unique_ptr<cvtflow::api::HostSimulation> simulation;
    cvtflow_log_function log = nullptr;
    void* log_user = nullptr;
    std::vector<std::string> logged{};                         ///< notices that the log has seen
    cvtflow::engine::LifeCount life{};                         ///< count of the owner and of calls that may call back
    std::shared_ptr<cvtflow::tasks::RunObserver> recording{};  ///< of which the core library knows nothing; ends before the simulation
};

namespace cvtflow::api {

/// Writes code and text into a caller's message, as far as its size allows; nullptr: nothing. @return code
cvtflow_code say(cvtflow_message* message, ErrorCode code, const char* text) noexcept;

/// Largest number of a code.
inline constexpr int last_code = 99;

/// What the library knows, as JSON. @param what a subject (cvtflow_describe); empty: all of them   @throws Error (argument)
[[nodiscard]] std::string description(std::string_view what);

/// Copies a text and its 0 to where a caller has *size bytes; *size becomes what is needed. @throws Error (argument) if it does not fit
void give_text(const std::string& whole, char* text, std::size_t* size);

/// Translates the exception in flight. @return its code
cvtflow_code say_exception(cvtflow_message* message) noexcept;

/// Runs `action`, in the host's floating-point environment; whatever it throws becomes a code and a message.
template <class Action>
cvtflow_code caught(cvtflow_message* message, Action&& action) noexcept {
    try {
        action();
        return say(message, ErrorCode::none, "");
    } catch (...) {
        return say_exception(message);
    }
}

/// Runs `action` in the default environment, with enough stack. @param otherwise code of exceptions that are no Error
template <class Action>
cvtflow_code guarded(cvtflow_message* message, Action&& action, ErrorCode otherwise = ErrorCode::internal) noexcept {
    return caught(message, [&] { entered(otherwise, action); });
}

/// Fills a versioned struct of the caller's, which begins with its size. @throws Error (argument) for NULL, or a size that no version has
template <class Struct>
void fill_versioned(Struct* callers, const char* name, std::type_identity_t<Struct> ours) {
    Struct& theirs = given(callers, name);
    if (theirs.size < sizeof ours) {
        throw Error(ErrorCode::argument,
                    "size: " + std::to_string(theirs.size) + " bytes, the first version has " + std::to_string(sizeof ours));
    }
    ours.size = theirs.size;
    theirs = ours;
}

/// The simulation behind a handle. @throws Error (argument) for NULL
[[nodiscard]] inline HostSimulation& of(const cvtflow_simulation* simulation) { return *given(simulation, "simulation").simulation; }

}  // namespace cvtflow::api
