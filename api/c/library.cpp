/// The library as a whole, and the C interface to it, to scenes and to records.

#include <algorithm>
#include <cvtflow/version.hpp>
#include <vector>

#include "api/c/boundary.hpp"
#include "engine/thread/worker_threads.hpp"

namespace cvtflow {
inline namespace v0 {

std::string library_version() { return CVTFLOW_VERSION_TEXT; }

bool shutdown() noexcept {
    const api::FloatingDefaults defaults;
    return engine::end_worker_threads();
}

}  // namespace v0
}  // namespace cvtflow

using namespace cvtflow;

extern "C" {

const char* cvtflow_version(void) { return CVTFLOW_VERSION_TEXT; }
const char* cvtflow_code_name(int32_t code) { return error_name(static_cast<ErrorCode>(code)); }
cvtflow_code cvtflow_shutdown(void) { return shutdown() ? CVTFLOW_OK : CVTFLOW_BUSY; }

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

cvtflow_code cvtflow_record_open(const char* path, cvtflow_record** record, cvtflow_message* message) {
    return api::guarded(message, [&] {
        Record opened(&api::given(path, "path"));
        std::string status = opened.status();
        std::vector<Column> channels = opened.channels();
        api::given(record, "record") = new cvtflow_record{std::move(opened), std::move(status), std::move(channels)};
    });
}

void cvtflow_record_close(cvtflow_record* record) { delete record; }

const char* cvtflow_record_status(const cvtflow_record* record) { return record != nullptr ? record->status.c_str() : ""; }
size_t cvtflow_record_rows(const cvtflow_record* record) { return record != nullptr ? record->record.rows() : 0; }
size_t cvtflow_record_channel_count(const cvtflow_record* record) { return record != nullptr ? record->channels.size() : 0; }

cvtflow_code cvtflow_record_describe(const cvtflow_record* record, size_t channel, cvtflow_channel_info* info, cvtflow_message* message) {
    return api::guarded(message, [&] {
        const std::vector<Column>& rows = api::given(record, "record").channels;
        if (channel >= rows.size())
            throw Error(ErrorCode::argument, "channel: number " + std::to_string(channel) + " of " + std::to_string(rows.size()));
        const Column& row = rows[channel];
        const cvtflow_channel_info ours{sizeof ours, 0, row.name.c_str(), row.unit.c_str(), row.description.c_str(), row.width};
        api::fill_versioned(&api::given(info, "info"), &ours, sizeof ours, sizeof ours);
    });
}

cvtflow_code cvtflow_record_read(const cvtflow_record* record, const char* channel, size_t first, size_t count, double* values, size_t size,
                                 cvtflow_message* message) {
    return api::guarded(message, [&] {
        const std::vector<double> rows = api::given(record, "record").record.read(&api::given(channel, "channel"), first, count);
        if (rows.size() != size)
            throw Error(ErrorCode::argument, "size: " + std::to_string(size) + " for " + std::to_string(rows.size()) + " values");
        std::copy(rows.begin(), rows.end(), &api::given(values, "values"));
    });
}

}  // extern "C"
