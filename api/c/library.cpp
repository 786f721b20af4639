/// The library as a whole, and the C interface to it and to scenes; what becomes of exceptions there.

#include <algorithm>
#include <cstring>
#include <new>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "api/c/boundary.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tasks/scene/units.hpp"

/// Version of the library that these objects are linked to (api/CMakeLists.txt).
extern const char* const cvtflow_version_text;

namespace cvtflow {

namespace api {

cvtflow_code say(cvtflow_message* message, ErrorCode code, const char* text) noexcept {
    constexpr std::size_t head = offsetof(cvtflow_message, text);
    if (message == nullptr) return static_cast<cvtflow_code>(code);
    const std::size_t size = message->size == 0 ? sizeof *message : message->size;  // 0: a struct of zeros; it has not grown yet
    if (size < head) return static_cast<cvtflow_code>(code);
    message->code = static_cast<std::int32_t>(code);
    if (size == head) return static_cast<cvtflow_code>(code);
    const std::size_t length = std::min(std::strlen(text), size - head - 1);
    std::memcpy(message->text, text, length);
    message->text[length] = '\0';
    return static_cast<cvtflow_code>(code);
}

cvtflow_code say_exception(cvtflow_message* message) noexcept {
    try {
        throw;
    } catch (const Error& error) {
        return say(message, error.code(), error.what());
    } catch (const std::bad_alloc&) {
        return say(message, ErrorCode::memory, "no memory");
    } catch (const std::exception& error) {
        return say(message, ErrorCode::internal, error.what());
    } catch (...) {
        return say(message, ErrorCode::internal, "an exception of unknown type");
    }
}

void give_text(const std::string& whole, char* text, std::size_t* size) {
    const std::size_t needed = whole.size() + 1;
    const std::size_t room = std::exchange(given(size, "size"), needed);
    if (text == nullptr) return;
    if (room < needed) throw Error(ErrorCode::argument, "size: " + std::to_string(room) + " bytes for a text of " + std::to_string(needed));
    std::memcpy(text, whole.c_str(), needed);
}

}  // namespace api
}  // namespace cvtflow

using namespace cvtflow;

namespace {

/// A new handle of a scene that `make` returns.
template <class Make>
cvtflow_code scene_by(cvtflow_scene** scene, cvtflow_message* message, Make&& make) {
    const auto action = [&] {
        cvtflow_scene*& place = api::given(scene, "scene");
        place = new cvtflow_scene{std::make_shared<const api::SceneData>(make())};
    };
    return api::guarded(message, action, ErrorCode::scene);
}

/// Values that a scene and its state file must have in common, as text.
[[nodiscard]] std::string resolution(const tasks::Scene& scene) {
    std::string text;
    for (const std::string_view key : tasks::state_keys()) text += tasks::value_text(*tasks::find_parameter(key), scene) + " ";
    return text;
}

[[nodiscard]] double quantity(const std::string& text, const std::string& unit) {
    const auto parsed = tasks::parse_quantity(text);
    if (const auto* wrong = std::get_if<std::string>(&parsed)) throw Error(ErrorCode::argument, "\"" + text + "\" " + *wrong);
    const auto& read = std::get<tasks::Quantity>(parsed);
    const tasks::Dimension expected = tasks::dimension_of(unit);
    const std::string expectation = ", expected " + std::string(tasks::dimension_name(expected)) + (unit == "1" ? "" : " (" + unit + ")");
    if (!read.has_unit && unit != "1") throw Error(ErrorCode::argument, "\"" + text + "\" has no unit" + expectation);
    if (read.dimension == expected) return read.value;
    const std::string name(tasks::dimension_name(read.dimension));
    throw Error(ErrorCode::argument, "\"" + text + "\" " + (name.empty() ? "has another dimension" : "is " + name) + expectation);
}

}  // namespace

extern "C" {

const char* cvtflow_version(void) { return cvtflow_version_text; }
const char* cvtflow_code_name(int32_t code) { return api::code_name(static_cast<ErrorCode>(code)); }

cvtflow_code cvtflow_describe(const char* what, char* text, size_t* size, cvtflow_message* message) {
    return api::guarded(message, [&] { api::give_text(api::description(what != nullptr ? what : ""), text, size); });
}

cvtflow_code cvtflow_quantity(const char* text, const char* unit, double* value, cvtflow_message* message) {
    const auto action = [&] { api::given(value, "value") = quantity(&api::given(text, "text"), &api::given(unit, "unit")); };
    return api::guarded(message, action, ErrorCode::argument);
}

cvtflow_code cvtflow_scene_read(const char* path, cvtflow_scene** scene, cvtflow_message* message) {
    return scene_by(scene, message, [&] { return tasks::read_scene(&api::given(path, "path")); });
}

cvtflow_code cvtflow_scene_parse(const char* text, const char* name, cvtflow_scene** scene, cvtflow_message* message) {
    return scene_by(scene, message, [&] { return tasks::parse_scene(&api::given(text, "text"), name != nullptr ? name : "scene.toml"); });
}

cvtflow_code cvtflow_scene_ready(const char* name, cvtflow_scene** scene, cvtflow_message* message) {
    return scene_by(scene, message, [&] { return tasks::read_ready_scene(&api::given(name, "name")); });
}

cvtflow_code cvtflow_scene_with(const cvtflow_scene* scene, const char* const* settings, size_t count, cvtflow_scene** changed,
                                cvtflow_message* message) {
    return scene_by(changed, message, [&] {
        std::vector<std::string> texts;
        for (const char* const setting : api::given(settings, count, "settings")) texts.emplace_back(&api::given(setting, "a setting"));
        tasks::Scene made = api::given(scene, "scene").scene();
        tasks::set_values(made, texts, "");
        return made;
    });
}

cvtflow_code cvtflow_scene_with_detail(const cvtflow_scene* scene, const char* preset, cvtflow_scene** changed, cvtflow_message* message) {
    return scene_by(changed, message, [&] {
        const tasks::Scene& before = api::given(scene, "scene").scene();
        tasks::Scene made = before;
        tasks::apply_detail(made, &api::given(preset, "preset"));
        if (resolution(made) != resolution(before)) made.state_file.clear();
        return made;
    });
}

cvtflow_code cvtflow_scene_text(const cvtflow_scene* scene, char* text, size_t* size, cvtflow_message* message) {
    return api::guarded(message, [&] { api::give_text(tasks::write_scene(api::given(scene, "scene").scene()), text, size); });
}

cvtflow_code cvtflow_scene_value(const cvtflow_scene* scene, const char* key, char* text, size_t* size, cvtflow_message* message) {
    return api::guarded(message, [&] {
        const tasks::Parameter* parameter = tasks::find_parameter(&api::given(key, "key"));
        if (parameter == nullptr) throw Error(ErrorCode::argument, "no key '" + std::string(key) + "'" + tasks::key_hint(key));
        api::give_text(tasks::value_text(*parameter, api::given(scene, "scene").scene()), text, size);
    });
}

const char* cvtflow_scene_name(const cvtflow_scene* scene) { return scene != nullptr ? scene->scene().name.c_str() : ""; }
void cvtflow_scene_release(cvtflow_scene* scene) { delete scene; }

}  // extern "C"
