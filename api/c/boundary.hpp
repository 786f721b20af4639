#pragma once
/// Boundary of C and C++: handles, and a wall that no exception passes. Internal to api.

#include <cvtflow/cvtflow.h>

#include <cvtflow/record.hpp>
#include <cvtflow/simulation.hpp>
#include <type_traits>
#include <vector>

#include "api/host/entry.hpp"
#include "engine/thread/guards.hpp"

struct cvtflow_scene {
    cvtflow::Scene scene;
};

struct cvtflow_simulation {
    cvtflow::Simulation simulation;
    cvtflow_log_function log = nullptr;
    void* log_user = nullptr;
    std::vector<std::string> logged{};  ///< notices that the log has seen
    cvtflow::engine::LifeCount life{};  ///< count of the owner and of calls that may call back
};

struct cvtflow_record {
    cvtflow::Record record;
    std::string status;
    std::vector<cvtflow::Column> channels;
};

namespace cvtflow::api {

/// Writes code and text into a caller's message, as far as its size allows; nullptr: nothing. @return code
cvtflow_code say(cvtflow_message* message, ErrorCode code, const char* text) noexcept;

/// Translates the exception in flight. @return its code
cvtflow_code say_exception(cvtflow_message* message) noexcept;

/// Runs `action`; whatever it throws becomes a code and a message.
template <class Action>
cvtflow_code guarded(cvtflow_message* message, Action&& action) noexcept {
    try {
        action();
        return say(message, ErrorCode::none, "");
    } catch (...) {
        return say_exception(message);
    }
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

}  // namespace cvtflow::api
