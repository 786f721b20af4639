#pragma once
/// Motions of a variator on which methods show their order.

#include <vector>

#include "model/start/start_state.hpp"

namespace cvtflow::claims {

/// A scene whose right-hand side is smooth where it goes: friction everywhere below saturation, so linear in speed; all else in contact.
struct Smooth {
    model::Parameters parameters;
    std::vector<double> state;
    std::vector<model::Phase> phases;
};

/// A free ring that turns fast, every coordinate with a speed of its own.
[[nodiscard]] Smooth disturbed_ring();
/// A ring around shaft 1, clamped between its elastic sheaves and turning: every tip deep in contact, none about to leave.
[[nodiscard]] Smooth clamped_ring();

inline constexpr double smooth_span = 1.6e-6;  ///< s: a period of the fastest waves, too short for a tip to come or go

[[nodiscard]] double distance(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace cvtflow::claims
