#include <cvtflow/error.hpp>
#include <cvtflow/scene.hpp>
#include <variant>
#include <vector>

#include "api/simulation_impl.hpp"
#include "engine/base/text.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow {
inline namespace v0 {

namespace {

/// Values that the scene and its state file must have in common, as text.
[[nodiscard]] std::string resolution(const tasks::Scene& scene) {
    std::string text;
    for (const std::string_view key : tasks::state_keys()) text += tasks::value_text(*tasks::find_parameter(key), scene) + " ";
    return text;
}

}  // namespace

const model::StartState& Scene::Data::placed_start() const {
    return mutex_.guard([this]() -> const model::StartState& {
        if (!placed_start_) placed_start_ = model::start_state(scene.parameters);
        return *placed_start_;
    });
}

std::uint64_t Scene::Data::fingerprint() const {
    return mutex_.guard([this] {
        if (!fingerprint_) fingerprint_ = api::fingerprint(scene);
        return *fingerprint_;
    });
}

Scene::Scene(std::shared_ptr<const Data> data) noexcept : data_(std::move(data)) {}

Scene Scene::read(const std::string& path) {
    return api::entered(ErrorCode::scene, [&] { return Scene(std::make_shared<const Data>(tasks::read_scene(path))); });
}

Scene Scene::parse(const std::string& text, const std::string& name) {
    return api::entered(ErrorCode::scene, [&] { return Scene(std::make_shared<const Data>(tasks::parse_scene(text, name))); });
}

Scene Scene::ready(const std::string& name) {
    return api::entered(ErrorCode::scene, [&] { return Scene(std::make_shared<const Data>(tasks::read_ready_scene(name))); });
}

std::vector<std::string> Scene::ready_names() {
    return api::entered(ErrorCode::scene, [] {
        std::vector<std::string> names;
        for (const tasks::ReadyScene& scene : tasks::ready_scenes()) names.push_back(scene.name);
        return names;
    });
}

Scene Scene::with(std::span<const std::string> settings) const {
    return api::entered(ErrorCode::scene, [&] {
        tasks::Scene changed = data_->scene;
        tasks::set_values(changed, settings, "");
        return Scene(std::make_shared<const Data>(std::move(changed)));
    });
}

Scene Scene::with(const std::string& setting) const { return with(std::span(&setting, 1)); }

Scene Scene::with_detail(const std::string& preset) const {
    return api::entered(ErrorCode::scene, [&] {
        tasks::Scene changed = data_->scene;
        tasks::apply_detail(changed, preset);
        if (resolution(changed) != resolution(data_->scene)) changed.state_file.clear();
        return Scene(std::make_shared<const Data>(std::move(changed)));
    });
}

const std::string& Scene::name() const noexcept { return data_->scene.name; }
const std::string& Scene::description() const noexcept { return data_->scene.description; }
std::string Scene::text() const {
    return api::entered(ErrorCode::internal, [&] { return tasks::write_scene(data_->scene); });
}

std::string Scene::value(const std::string& key) const {
    return api::entered(ErrorCode::internal, [&] {
        const tasks::Parameter* parameter = tasks::find_parameter(key);
        if (parameter == nullptr) throw Error(ErrorCode::argument, "no key '" + key + "'" + tasks::key_hint(key));
        return tasks::value_text(*parameter, data_->scene);
    });
}

std::vector<KeyInfo> scene_keys() {
    return api::entered(ErrorCode::internal, [] {
        const tasks::Scene defaults;
        std::vector<KeyInfo> keys;
        for (const tasks::Parameter& row : tasks::parameter_table()) {
            keys.push_back({std::string(row.key),
                            std::string(row.unit),
                            std::string(row.meaning),
                            tasks::value_text(row, defaults),
                            std::string(row.source),
                            row.min,
                            row.max,
                            {row.choices.begin(), row.choices.end()},
                            row.kind() == tasks::Kind::time_table});
        }
        return keys;
    });
}

DisplayUnit display_unit(const std::string& name, const std::string& unit) {
    const tasks::DisplayUnit how = tasks::display_unit(name, unit);
    return {std::string(how.unit), how.factor};
}

double quantity(const std::string& text, const std::string& unit) {
    return api::entered(ErrorCode::argument, [&] {
        const auto parsed = tasks::parse_quantity(text);
        if (const auto* wrong = std::get_if<std::string>(&parsed)) throw Error(ErrorCode::argument, "\"" + text + "\" " + *wrong);
        const auto& read = std::get<tasks::Quantity>(parsed);
        const tasks::Dimension expected = tasks::dimension_of(unit);
        const std::string expectation =
            ", expected " + std::string(tasks::dimension_name(expected)) + (unit == "1" ? "" : " (" + unit + ")");
        if (!read.has_unit && unit != "1") throw Error(ErrorCode::argument, "\"" + text + "\" has no unit" + expectation);
        if (read.dimension == expected) return read.value;
        const std::string name(tasks::dimension_name(read.dimension));
        throw Error(ErrorCode::argument, "\"" + text + "\" " + (name.empty() ? "has another dimension" : "is " + name) + expectation);
    });
}

}  // namespace v0
}  // namespace cvtflow
