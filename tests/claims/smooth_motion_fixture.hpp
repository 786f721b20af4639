#pragma once
/// Motions of the variator on which methods show their order.

#include <vector>

#include "tests/claims/rig_fixture.hpp"

namespace cvtflow::claims {

/// A scene whose right-hand side is smooth where it goes: friction everywhere below saturation, so linear in speed; all else in contact.
struct Smooth {
    model::Parameters parameters;
    std::vector<double> state;
    std::vector<model::Phase> phases;
};

constexpr double smooth_span = 1.6e-6;  ///< s: a period of the fastest waves, too short for a tip to come or go

/// A free ring that turns fast, every coordinate with a speed of its own.
[[nodiscard]] Smooth disturbed_ring();
/// A ring around shaft 1, clamped between its elastic sheaves and turning: every tip deep in contact, none about to leave.
[[nodiscard]] Smooth clamped_ring();

/// Of two states.
[[nodiscard]] double distance(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace cvtflow::claims
