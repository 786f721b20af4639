/// The library as a whole, and the C interface to it, to scenes and to records; what becomes of exceptions there.

#include <algorithm>
#include <cstring>
#include <cvtflow/version.hpp>
#include <new>
#include <utility>
#include <vector>

#include "api/c/boundary.hpp"
#include "engine/thread/worker_threads.hpp"

/// Version of the library that these objects are linked to (api/CMakeLists.txt).
extern const char* const cvtflow_version_text;

namespace cvtflow {
inline namespace v0 {

std::string library_version() { return cvtflow_version_text; }

bool shutdown() noexcept {
    const api::FloatingDefaults defaults;
    return engine::end_worker_threads();
}

}  // namespace v0

namespace api {

cvtflow_code say(cvtflow_message* message, ErrorCode code, const char* text) noexcept {
    constexpr std::size_t head = offsetof(cvtflow_message, text);
    if (message == nullptr) return static_cast<cvtflow_code>(code);
    const std::size_t size = message->size == 0 ? sizeof *message : message->size;  // 0: a struct of zeros; it has not grown yet
    if (size < head) return static_cast<cvtflow_code>(code);
    message->code = static_cast<std::int32_t>(code);
    if (size == head) return static_cast<cvtflow_code>(code);
    const std::size_t room = std::min(size - head, sizeof message->text) - 1;
    const std::size_t length = std::min(std::strlen(text), room);
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

}  // namespace api
}  // namespace cvtflow

using namespace cvtflow;

namespace {

/// Copies a text and its 0 to where a caller has *size bytes; *size becomes what is needed. @throws Error (argument) if it does not fit
void give_text(const std::string& whole, char* text, size_t* size) {
    const size_t needed = whole.size() + 1;
    const size_t room = std::exchange(api::given(size, "size"), needed);
    if (text == nullptr) return;
    if (room < needed) throw Error(ErrorCode::argument, "size: " + std::to_string(room) + " bytes for a text of " + std::to_string(needed));
    std::memcpy(text, whole.c_str(), needed);
}

}  // namespace

extern "C" {

const char* cvtflow_version(void) { return cvtflow_version_text; }
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
    return api::guarded(message, [&] { give_text(api::given(scene, "scene").scene.text(), text, size); });
}

cvtflow_code cvtflow_scene_value(const cvtflow_scene* scene, const char* key, char* text, size_t* size, cvtflow_message* message) {
    return api::guarded(message, [&] { give_text(api::given(scene, "scene").scene.value(&api::given(key, "key")), text, size); });
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
        api::fill_versioned(info, "info", {sizeof *info, 0, row.name.c_str(), row.unit.c_str(), row.description.c_str(), row.width});
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
