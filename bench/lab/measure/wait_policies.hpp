#pragma once
/// One profile per wait policy. OpenMP's runtimes read the policy from the environment when they are loaded, so each policy runs in a child
/// process.

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace cvtflow::bench {

struct WaitPolicy {
    std::string name;
    std::vector<std::string> executors;                            ///< executors that it affects
    std::vector<std::pair<std::string, std::string>> environment;  ///< set in the child; others of these names are unset
    std::vector<std::string> options;                              ///< of `cvtflow-lab profile`
};

/// All of them; the first changes nothing.
[[nodiscard]] std::vector<WaitPolicy> wait_policies();

/// Measurements of a child process.
struct PolicyResult {
    std::string name;
    std::string csv_rows;         ///< without a heading
    nlohmann::ordered_json json;  ///< its whole profile
};

/// Runs `cvtflow words…` once per policy, with the fused schedules that it concerns.
/// @param words "profile" and what to measure, without schedules and files   @param names schedules that the user named, of which to take;
/// none: all
/// @param progress called with one line before every child
/// @throws std::runtime_error if a child fails, with its message
[[nodiscard]] std::vector<PolicyResult> measure_policies(const std::vector<std::string>& words, const std::vector<std::string>& names,
                                                         const std::function<void(const std::string&)>& progress);

/// Time per step, factor against serial and processor time burnt, under every load: a row per schedule and policy.
[[nodiscard]] std::string policies_text(const std::vector<PolicyResult>& results);

}  // namespace cvtflow::bench
