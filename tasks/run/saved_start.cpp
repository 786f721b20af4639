#include "tasks/run/saved_start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <variant>

#include "engine/base/hash.hpp"
#include "engine/base/provenance.hpp"
#include "engine/record/run/state_file.hpp"
#include "model/observe/observation.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/parameter_table.hpp"

namespace cvtflow::tasks {

engine::StateHead head_of(const Scene& scene, std::string method) {
    Scene plain = scene;
    plain.name = plain.description = plain.state_file = "";
    plain.run = RunSettings();
    plain.run.method = method_of(scene);
    plain.run.step = scene.run.step;
    plain.run.output_interval = scene.run.output_interval;
    return {.program = engine::version_text(),
            .method = std::move(method),
            .scene_hash = engine::Hash().add(std::string_view(write_scene(plain))).value(),
            .scene = write_scene(scene)};
}

namespace {

/// Sections whose keys describe the machine, not the run or the operating point.
[[nodiscard]] bool describes_machine(const Parameter& parameter) {
    constexpr std::string_view sections[] = {"detail", "chain", "half", "plate", "joint", "tip", "pulley"};
    return std::find(std::begin(sections), std::end(sections), parameter.section()) != std::end(sections);
}

/// The scene that a state was settled with, if the state contains it.
[[nodiscard]] std::optional<Scene> settled_scene(const engine::SavedState& saved, const std::string& place) {
    return saved.scene.empty() ? std::nullopt : std::optional(parse_scene(saved.scene, place, StartState::recorded));
}

[[nodiscard]] bool same_coordinates(const model::ChainLayout& a, const model::ChainLayout& b) noexcept {
    return a.links == b.links && a.pulley_size == b.pulley_size && a.rigid == b.rigid;
}

[[nodiscard]] bool contains_coordinates(const engine::SavedState& saved, const model::ChainLayout& of) noexcept {
    return saved.state.size() >= static_cast<std::size_t>(of.control_begin()) &&
           saved.phases.size() == static_cast<std::size_t>(model::tips_per_link * of.links);
}

/// Energies of a state by kind, without the kinetic one [J]. The phases are the settled ones: what they hold is compared.
[[nodiscard]] std::array<double, model::energy_kinds> elastic_energies(const engine::SavedState& saved, const model::Parameters& machine) {
    const model::Variator variator(machine);
    std::vector<double> state(static_cast<std::size_t>(variator.layout().size()), 0.0);
    std::copy_n(saved.state.begin(), variator.layout().control_begin(), state.begin());
    std::vector<model::Phase> phases(saved.phases.size());
    std::transform(saved.phases.begin(), saved.phases.end(), phases.begin(),
                   [](std::uint8_t phase) { return phase == 0 ? model::Phase::free : model::Phase::touching; });
    model::Observer observer(variator);
    std::array<double, model::energy_kinds> energies = observer.observe(saved.time, state.data(), phases.data()).account.energy;
    energies[static_cast<std::size_t>(model::Energy::kinetic)] = 0.0;
    return energies;
}

/// start_misfit() of a state that was settled with the scene `then`.
[[nodiscard]] double misfit_between(const engine::SavedState& saved, const Scene& then, const Scene& scene) {
    if (model::Variator::same_machine(then.parameters, scene.parameters)) return 0.0;
    const model::ChainLayout saved_layout = model::layout_of(then.parameters);
    if (!contains_coordinates(saved, saved_layout) || !same_coordinates(saved_layout, model::layout_of(scene.parameters))) return 0.0;
    const auto before = elastic_energies(saved, then.parameters), now = elastic_energies(saved, scene.parameters);
    double change = 0.0, stored = 0.0;
    for (std::size_t kind = 0; kind < before.size(); ++kind) {
        change += std::abs(now[kind] - before[kind]);
        stored += before[kind];
    }
    if (change == 0.0) return 0.0;
    return std::isfinite(change / stored) ? change / stored : std::numeric_limits<double>::infinity();
}

}  // namespace

std::uint64_t content_hash(const engine::SavedState& saved) noexcept {
    return engine::Hash()
        .add(std::span<const double>(saved.state))
        .add(std::span<const std::uint8_t>(saved.phases))
        .add(std::string_view(saved.scene))
        .value();
}

double start_misfit(const engine::SavedState& saved, const Scene& scene) {
    const std::optional<Scene> then = settled_scene(saved, scene.state_file);
    return then ? misfit_between(saved, *then, scene) : 0.0;
}

std::string unfit_text(double misfit) {
    return fmt::format("the state does not fit this machine (its elastic energy differs by {:.2g} %)", 100.0 * misfit);
}

std::string unfit_text(const engine::SavedState& saved, const Scene& scene) {
    return has_coordinates(saved, settled_layout(saved, scene), scene) ? unfit_text(start_misfit(saved, scene))
                                                                       : "the state has the unknowns of another level of detail";
}

std::optional<model::ChainLayout> settled_layout(const engine::SavedState& saved, const Scene& scene) {
    const std::optional<Scene> then = settled_scene(saved, scene.state_file);
    return then ? std::optional(model::layout_of(then->parameters)) : std::nullopt;
}

bool has_coordinates(const engine::SavedState& saved, const std::optional<model::ChainLayout>& settled, const Scene& scene) {
    const model::ChainLayout scene_layout = model::layout_of(scene.parameters);
    return contains_coordinates(saved, scene_layout) && (!settled || same_coordinates(*settled, scene_layout));
}

bool start_fits(const engine::SavedState& saved, const Scene& scene) {
    const std::optional<Scene> then = settled_scene(saved, scene.state_file);
    if (!then) return has_coordinates(saved, std::nullopt, scene);
    return has_coordinates(saved, model::layout_of(then->parameters), scene) &&
           misfit_between(saved, *then, scene) <= start_misfit_tolerance;
}

void require_time_to_settle(const Scene& scene, const std::string& unfit) {
    if (scene.parameters.start.settling_time > 0.0) return;
    throw SimulationError(fmt::format("{}start.state: {}, and start.settling_time = 0 leaves no time to settle", scene.state_place, unfit));
}

std::shared_ptr<const engine::SavedState> fitting_start(const Scene& scene) {
    if (scene.state_file.empty()) return nullptr;
    auto saved = saved_start(scene);
    return start_fits(*saved, scene) ? saved : nullptr;
}

std::shared_ptr<const engine::SavedState> saved_start(const Scene& scene) {
    try {
        return scene.start_state.read(scene.state_file);
    } catch (const engine::RecordError& error) {
        throw engine::RecordError(fmt::format("{}start.state: {}", scene.state_place, error.what()));
    }
}

std::vector<std::string> start_differences(const engine::SavedState& saved, const Scene& scene) {
    std::vector<std::string> lines;
    const std::optional<Scene> then = settled_scene(saved, scene.state_file);
    if (!then) return lines;
    for (const auto& [key, is, was] : differing_keys(scene, *then, describes_machine))
        lines.push_back(fmt::format("{} = {}, settled with {}", key->key, is, was));
    return lines;
}

}  // namespace cvtflow::tasks
