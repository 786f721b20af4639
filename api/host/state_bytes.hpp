#pragma once
/// An integration state as bytes, for hosts to keep and bring back. Internal to api.
///
/// A state of engine/base/archive.hpp: hash of the scene, integration.

#include <cstddef>
#include <cstdint>
#include <cvtflow/error.hpp>
#include <span>
#include <vector>

#include "tasks/scene/scene.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow::api {

struct StateRecord {
    std::uint64_t fingerprint = 0;  ///< hash of the scene, equal if the state fits
    tasks::IntegrationState integration;
};

/// Hash of everything in a scene that the course of a simulation depends on; schedules, names, budgets and the end of the run are not.
[[nodiscard]] std::uint64_t fingerprint(const tasks::Scene& scene);

[[nodiscard]] std::vector<std::byte> write_state_bytes(std::uint64_t fingerprint, const tasks::IntegrationState& integration);
/// @throws Error (state) for bytes that are damaged or of another version
[[nodiscard]] StateRecord read_state_bytes(std::span<const std::byte> bytes);
/// Checks frame and checksum only. @throws Error (state)
void check_state_bytes(std::span<const std::byte> bytes);

}  // namespace cvtflow::api
