#pragma once
/// Reasons why a run ended early: values inside the graph, texts outside it.

#include <optional>
#include <string>

namespace cvtflow::tasks {

enum class FaultKind {
    none,
    non_finite,
    penetration,
    left_sheave,
    max_steps,
    max_wall,
    cancelled,
    step_size,
    blow_up,
    step_too_short,
    not_steady
};

struct Fault {
    FaultKind kind = FaultKind::none;
    double time = 0.0;            ///< [s]
    std::optional<int> pin = {};  ///< pin whose link shows it; nothing: none in particular
    double value = 0.0;           ///< depth or radius [m], limit of the budget, largest error of means over run.steady, or slip [1]
    double limit = 0.0;           ///< limit that `value` exceeded

    [[nodiscard]] explicit operator bool() const noexcept { return kind != FaultKind::none; }
    /// One line for a user: what happened, when, where.
    [[nodiscard]] std::string message() const;
    /// Short name for records: "non_finite", "penetration", …
    [[nodiscard]] std::string name() const;
};

}  // namespace cvtflow::tasks
