#include "tasks/run/saved_start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <variant>

#include "engine/record/run/state_file.hpp"
#include "model/observe/observation.hpp"
#include "tasks/scene/parameter_table.hpp"

namespace cvtflow::tasks {

double suspicion_of(const engine::SavedState& saved) {
    for (const engine::Attribute& attribute : saved.attributes) {
        if (attribute.name != suspicion_attribute) continue;
        if (const auto* value = std::get_if<double>(&attribute.value)) return *value;
    }
    return 0.0;
}

namespace {

const std::string* text_attribute(const engine::SavedState& saved, std::string_view name) {
    for (const engine::Attribute& attribute : saved.attributes) {
        if (attribute.name == name) return std::get_if<std::string>(&attribute.value);
    }
    return nullptr;
}

/// Sections whose keys describe the machine, not the run or the operating point.
[[nodiscard]] bool describes_machine(const Parameter& parameter) {
    constexpr std::string_view sections[] = {"detail", "chain", "half", "plate", "joint", "tip", "pulley"};
    return std::find(std::begin(sections), std::end(sections), parameter.section()) != std::end(sections);
}

/// The scene that a state was settled with, if the state contains it.
[[nodiscard]] std::optional<Scene> settled_scene(const engine::SavedState& saved, const std::string& place) {
    const std::string* text = text_attribute(saved, "scene");
    return text == nullptr ? std::nullopt : std::optional(parse_scene(*text, place, StartState::recorded));
}

[[nodiscard]] bool same_coordinates(const model::ChainLayout& a, const model::ChainLayout& b) noexcept {
    return a.order == b.order && a.links == b.links && a.pulley_size == b.pulley_size && a.rigid == b.rigid;
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

}  // namespace

std::string_view settled_scene_text(const engine::SavedState& saved) {
    const std::string* text = text_attribute(saved, "scene");
    return text == nullptr ? std::string_view() : std::string_view(*text);
}

model::Parameters settled_parameters(const engine::SavedState& saved, const Scene& scene) {
    model::Parameters parameters = scene.parameters;
    if (const std::optional<Scene> then = settled_scene(saved, scene.state_file)) parameters.detail = then->parameters.detail;
    return parameters;
}

double start_misfit(const engine::SavedState& saved, const Scene& scene) {
    const std::optional<Scene> then = settled_scene(saved, scene.state_file);
    if (!then || model::Variator::same_machine(then->parameters, scene.parameters)) return 0.0;
    const model::ChainLayout own = model::layout_of(then->parameters);
    const bool complete = saved.state.size() >= static_cast<std::size_t>(own.control_begin()) &&
                          saved.phases.size() == static_cast<std::size_t>(model::tips_per_link * own.links);
    if (!complete || !same_coordinates(own, model::layout_of(scene.parameters))) return 0.0;
    const auto before = elastic_energies(saved, then->parameters), now = elastic_energies(saved, scene.parameters);
    double change = 0.0, stored = 0.0;
    for (std::size_t kind = 0; kind < before.size(); ++kind) {
        change += std::abs(now[kind] - before[kind]);
        stored += before[kind];
    }
    if (change == 0.0) return 0.0;
    return std::isfinite(change / stored) ? change / stored : std::numeric_limits<double>::infinity();
}

std::string unfit_text(double misfit) {
    return fmt::format("the state does not fit this machine (its elastic energy differs by {:.2g} %)", 100.0 * misfit);
}

bool start_fits(const engine::SavedState& saved, const Scene& scene) { return start_misfit(saved, scene) <= start_misfit_tolerance; }

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
    std::optional<Scene> then = settled_scene(saved, scene.state_file);
    if (!then) return lines;
    for (const Parameter& parameter : parameter_table()) {
        if (!describes_machine(parameter)) continue;
        const std::string was = value_text(parameter, *then);
        const std::string is = value_text(parameter, scene);
        if (was != is) lines.push_back(fmt::format("{} = {}, settled with {}", parameter.key, is, was));
    }
    return lines;
}

}  // namespace cvtflow::tasks
