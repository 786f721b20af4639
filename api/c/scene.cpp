#include <vector>

#include "api/c/boundary.hpp"

using namespace cvtflow;

extern "C" {

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
