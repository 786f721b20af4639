#pragma once
/// Where C meets C++: handles, and a wall that no exception passes. Internal to api.

#include <cvtflow/cvtflow.h>

#include <cvtflow/simulation.hpp>

struct cvtflow_scene {
    cvtflow::Scene scene;
};

struct cvtflow_simulation {
    cvtflow::Simulation simulation;
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

/// The object behind a pointer. @throws Error (argument) that names what is NULL
template <class T>
T& given(T* pointer, const char* name) {
    if (pointer == nullptr) throw Error(ErrorCode::argument, std::string(name) + " is NULL");
    return *pointer;
}

/// Fills a versioned struct of the caller's, as far as its size goes. Both begin with their size.
/// @throws Error (argument) for a size that no version has
void fill_versioned(void* callers, const void* ours, std::size_t our_size, std::size_t first_size);

}  // namespace cvtflow::api
