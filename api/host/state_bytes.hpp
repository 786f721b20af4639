#pragma once
/// An integration state as bytes, for hosts to keep and bring back. Internal to api.
///
///     "CVTFLOW6"  fingerprint of the scene  held inputs  integration state  checksum of all before
///
/// Numbers lie as they are in memory (little-endian, IEEE 754): states travel between processes, not between architectures.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <cvtflow/error.hpp>
#include <span>
#include <vector>

#include "model/force/pulley.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow::api {

struct StateRecord {
    std::uint64_t fingerprint = 0;  ///< hash of the scene, equal if the state fits
    model::HeldInputs held;
    tasks::IntegrationState integration;
};

/// Hash of everything in a scene that the course of a simulation depends on; schedules, names, budgets and the end of the run are not.
[[nodiscard]] std::uint64_t fingerprint(const tasks::Scene& scene);

/// Bytes of a StateRecord of these.
[[nodiscard]] std::vector<std::byte> write_state_bytes(std::uint64_t fingerprint, const model::HeldInputs& held,
                                                       const tasks::IntegrationState& integration);
/// @throws Error (state) for bytes that are damaged or of another version
[[nodiscard]] StateRecord read_state_bytes(std::span<const std::byte> bytes);
/// Checks frame and checksum only. @throws Error (state)
void check_state_bytes(std::span<const std::byte> bytes);

/// Bytes of a saved state that have not been read yet.
class UnreadBytes {
public:
    /// @param truncated message of the error where they end too early
    UnreadBytes(std::span<const std::byte> rest, const char* truncated) : rest_(rest), truncated_(truncated) {}

    /// The next `size` bytes. @throws Error (state)
    [[nodiscard]] std::span<const std::byte> take(std::size_t size) {
        if (rest_.size() < size) throw Error(ErrorCode::state, truncated_);
        const auto taken = rest_.first(size);
        rest_ = rest_.subspan(size);
        return taken;
    }
    template <class T>
    [[nodiscard]] T value() {
        T value;
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }
    [[nodiscard]] std::span<const std::byte> rest() const noexcept { return rest_; }

private:
    std::span<const std::byte> rest_;
    const char* truncated_;
};

}  // namespace cvtflow::api
