#include "api/host/state_bytes.hpp"

#include <string_view>

#include "engine/base/hash.hpp"

namespace cvtflow::api {

namespace {

/// @throws Error (state) for what a state is refused for
template <class Action>
auto of_state(const Action& action) {
    try {
        return action();
    } catch (const engine::ArchiveError& error) {
        throw Error(ErrorCode::state, std::string("saved state: ") + error.what());
    }
}

}  // namespace

std::uint64_t fingerprint(const tasks::Scene& scene) {
    tasks::Scene plain = scene;
    const tasks::RunSettings defaults;
    plain.name = plain.description = plain.state_file = "";
    plain.run = defaults;
    plain.run.method = method_of(scene);
    plain.run.step = scene.run.step;
    plain.run.output_interval = scene.run.output_interval;
    return engine::Hash().add(std::string_view(tasks::write_scene(plain))).value();
}

std::vector<std::byte> write_state_bytes(std::uint64_t fingerprint, const tasks::IntegrationState& integration) {
    std::vector<std::byte> bytes;
    bytes.reserve(integration.energy.size() + integration.method.size() + 64 * integration.state.size());
    engine::begin_state(bytes);
    engine::Archive archive = engine::Archive::to(bytes);
    archive("scene_hash", fingerprint);
    const_cast<tasks::IntegrationState&>(integration).visit(archive);
    engine::seal_state(bytes);
    return bytes;
}

void check_state_bytes(std::span<const std::byte> bytes) {
    of_state([&] { return engine::fields_of_state(bytes); });
}

StateRecord read_state_bytes(std::span<const std::byte> bytes) {
    return of_state([&] {
        StateRecord record;
        engine::read_fields(engine::fields_of_state(bytes), [&](auto& archive) {
            archive("scene_hash", record.fingerprint);
            record.integration.visit(archive);
        });
        return record;
    });
}

}  // namespace cvtflow::api
