/// The library as a whole, and the C interface to it and to scenes; what becomes of exceptions there.

#include <algorithm>
#include <cstring>
#include <cvtflow/version.hpp>
#include <new>
#include <utility>
#include <vector>

#include "api/c/boundary.hpp"

/// Version of the library that these objects are linked to (api/CMakeLists.txt).
extern const char* const cvtflow_version_text;

namespace cvtflow {
inline namespace v0 {

std::string library_version() { return cvtflow_version_text; }

}  // namespace v0

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

extern "C" {

const char* cvtflow_version(void) { return cvtflow_version_text; }
const char* cvtflow_code_name(int32_t code) { return error_name(static_cast<ErrorCode>(code)); }

cvtflow_code cvtflow_describe(const char* what, char* text, size_t* size, cvtflow_message* message) {
    return api::guarded(message, [&] { api::give_text(api::description(what != nullptr ? what : ""), text, size); });
}

cvtflow_code cvtflow_quantity(const char* text, const char* unit, double* value, cvtflow_message* message) {
    return api::guarded(message, [&] { api::given(value, "value") = quantity(&api::given(text, "text"), &api::given(unit, "unit")); });
}

cvtflow_code cvtflow_scene_read(const char* path, cvtflow_scene** scene, cvtflow_message* message) {
    return api::guarded(message, [&] { api::given(scene, "scene") = new cvtflow_scene{Scene::read(&api::given(path, "path"))}; });
}

cvtflow_code cvtflow_scene_parse(const char* text, const char* name, cvtflow_scene** scene, cvtflow_message* message) {
    return api::guarded(message, [&] {
        api::given(scene, "scene") = new cvtflow_scene{Scene::parse(&api::given(text, "text"), name != nullptr ? name : "scene.toml")};
    });
}

cvtflow_code cvtflow_scene_ready(const char* name, cvtflow_scene** scene, cvtflow_message* message) {
    return api::guarded(message, [&] { api::given(scene, "scene") = new cvtflow_scene{Scene::ready(&api::given(name, "name"))}; });
}

cvtflow_code cvtflow_scene_with(const cvtflow_scene* scene, const char* const* settings, size_t count, cvtflow_scene** changed,
                                cvtflow_message* message) {
    return api::guarded(message, [&] {
        std::vector<std::string> texts;
        if (count > 0) static_cast<void>(api::given(settings, "settings"));
        for (size_t k = 0; k < count; ++k) texts.emplace_back(&api::given(settings[k], "a setting"));
        api::given(changed, "changed") = new cvtflow_scene{api::given(scene, "scene").scene.with(texts)};
    });
}

cvtflow_code cvtflow_scene_with_detail(const cvtflow_scene* scene, const char* preset, cvtflow_scene** changed, cvtflow_message* message) {
    return api::guarded(message, [&] {
        api::given(changed, "changed") = new cvtflow_scene{api::given(scene, "scene").scene.with_detail(&api::given(preset, "preset"))};
    });
}

cvtflow_code cvtflow_scene_text(const cvtflow_scene* scene, char* text, size_t* size, cvtflow_message* message) {
    return api::guarded(message, [&] { api::give_text(api::given(scene, "scene").scene.text(), text, size); });
}

cvtflow_code cvtflow_scene_value(const cvtflow_scene* scene, const char* key, char* text, size_t* size, cvtflow_message* message) {
    return api::guarded(message, [&] { api::give_text(api::given(scene, "scene").scene.value(&api::given(key, "key")), text, size); });
}

const char* cvtflow_scene_name(const cvtflow_scene* scene) { return scene != nullptr ? scene->scene.name().c_str() : ""; }
void cvtflow_scene_release(cvtflow_scene* scene) { delete scene; }

}  // extern "C"
