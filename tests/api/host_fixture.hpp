#pragma once
/// A host program's view: the installed headers, a small scene, and how many threads there are.

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <cvtflow/cvtflow.hpp>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

namespace cvtflow::host {

#if defined(__SANITIZE_THREAD__)
inline constexpr bool thread_sanitizer = true;  ///< no support for oneTBB and OpenMP: false reports of races
#else
inline constexpr bool thread_sanitizer = false;
#endif
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool address_sanitizer = true;  ///< more memory on the stack; malloc is the sanitizer's
#else
inline constexpr bool address_sanitizer = false;
#endif

/// CVTFLOW_TEST_DEPTH, as in tests/sample_fixture.hpp.
inline bool is_deep() {
    const char* given = std::getenv("CVTFLOW_TEST_DEPTH");
    return given != nullptr && std::string(given) == "deep";
}

/// Threads of the caller alone, and private threads of the simulation where they can be checked.
inline std::vector<Threads> ways() {
    if (thread_sanitizer) return {Threads::caller()};
    return {Threads::caller(), Threads::private_arena(2)};
}

/// 24 pins; settles for 0.3 ms only: cheap, and full of transitions.
inline Scene tiny(std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"start.settling_time=0.3 ms", "start.ramp_time=0.3 ms", "run.step=100 ns"});
    return Scene::read(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml").with(more);
}

/// Hash after a short run, on the calling thread.
inline std::uint64_t serial_hash(const Scene& scene, double until) {
    Simulation simulation(scene);
    simulation.advance_to(until);
    return simulation.hash();
}

/// Threads of this process.
inline long threads() {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return std::distance(begin(tasks), end(tasks));
}

/// Code of the error that `action` throws; none if it throws none.
template <class Action>
ErrorCode code_of(const Action& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.code();
    }
    return ErrorCode::none;
}

/// Text of the error that `action` throws.
template <class Action>
std::string error_of(const Action& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

/// Waits until `condition` holds. @return whether it did within 20 s
template <class Condition>
bool eventually(const Condition& condition) {
    using namespace std::chrono_literals;
    for (int attempt = 0; attempt < 20000; ++attempt) {
        if (condition()) return true;
        std::this_thread::sleep_for(1ms);
    }
    return false;
}

}  // namespace cvtflow::host
