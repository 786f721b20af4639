#pragma once
/// Contents of a public scene. Internal to api.

#include <cstdint>
#include <cvtflow/scene.hpp>
#include <optional>
#include <utility>

#include "engine/thread/guards.hpp"
#include "model/start/start_state.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow {
inline namespace v0 {

struct Scene::Data {
    explicit Data(tasks::Scene from) : scene(std::move(from)) {}

    const tasks::Scene scene;

    /// Geometric start of its simulations, placed by the first one. @throws as model::start_state
    [[nodiscard]] const model::StartState& placed_start() const;
    /// api::fingerprint() of the scene, computed once.
    [[nodiscard]] std::uint64_t fingerprint() const;

private:
    mutable engine::Mutex mutex_;
    mutable std::optional<model::StartState> placed_start_;
    mutable std::optional<std::uint64_t> fingerprint_;
};

}  // namespace v0
}  // namespace cvtflow
