/// The C interface to what needs threads and files: worker threads, recording, sweeps, records.

#include <algorithm>
#include <chrono>
#include <cvtflow/record.hpp>
#include <cvtflow/tune.hpp>
#include <sstream>
#include <string>
#include <utility>

#include "api/c/boundary.hpp"
#include "api/sweep_run.hpp"
#include "engine/thread/worker_threads.hpp"
#include "tasks/scene/ready_scenes.hpp"

struct cvtflow_record {
    cvtflow::Record record;
    std::string status;
    std::vector<cvtflow::Column> channels;
};

namespace cvtflow {
inline namespace v0 {

bool shutdown() noexcept {
    const api::FloatingDefaults defaults;
    return engine::end_worker_threads();
}

}  // namespace v0

namespace {

/// Calls the host with the progress of a sweep, one thread at a time, which may request the end.
class Progress {
public:
    Progress(cvtflow_progress_function function, void* user, long cases) : function_(function), user_(user) {
        now_.size = sizeof now_;
        now_.cases = cases;
    }

    /// After a case. @return whether the sweep shall end
    [[nodiscard]] bool report(const tasks::BatchProgress& now) {
        return mutex_.guard([&] {
            now_.before = now.before;
            now_.done = now.done;
            now_.failed = now.failed;
            now_.wall = now.wall;
            return call();
        });
    }
    /// Between two steps of a case, by every worker; at intervals. @return whether the sweep shall end
    [[nodiscard]] bool ask() {
        if (!alone_.enter()) return false;
        const bool due = Clock::now() - called_ >= between_calls;
        const bool ends = due && mutex_.guard([&] { return call(); });
        alone_.leave();
        return ends;
    }

private:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::milliseconds between_calls{50};

    [[nodiscard]] bool call() {
        const bool ends = function_ != nullptr && function_(&now_, user_) != 0;
        called_ = Clock::now();
        return ends;
    }

    cvtflow_progress_function function_;
    void* user_;
    cvtflow_progress now_{};
    Clock::time_point called_{};
    engine::ReentryGuard alone_;
    engine::Mutex mutex_;
};

void run_sweep(const char* file, const char* folder, int threads, cvtflow_progress_function function, void* user) {
    const tasks::Sweep sweep =
        api::entered(ErrorCode::scene, [&] { return tasks::read_sweep(&api::given(file, "file"), tasks::find_scene); });
    Progress progress(function, user, sweep.cases());
    const std::function<bool()> asked = [&progress] { return progress.ask(); };
    engine::Cancellation cancel(asked);
    if (progress.report({}) || folder == nullptr) {
        if (folder == nullptr) return;
        throw Error(ErrorCode::cancelled, "cancelled");
    }
    const bool finished = api::run_sweep(sweep, folder, threads, cancel, [&](const tasks::BatchProgress& now) {
        if (progress.report(now)) cancel.request();
    });
    if (!finished) throw Error(ErrorCode::cancelled, "cancelled");
}

}  // namespace
}  // namespace cvtflow

using namespace cvtflow;

extern "C" {

cvtflow_code cvtflow_shutdown(void) { return shutdown() ? CVTFLOW_OK : CVTFLOW_BUSY; }

cvtflow_code cvtflow_record_begin(cvtflow_simulation* simulation, const char* path, int32_t replace, cvtflow_message* message) {
    return api::guarded(message, [&] {
        cvtflow_simulation& handle = api::given(simulation, "simulation");
        handle.recording = std::make_shared<Recording>(handle.simulation, &api::given(path, "path"), replace != 0);
    });
}

cvtflow_code cvtflow_record_finish(cvtflow_simulation* simulation, int32_t complete, cvtflow_message* message) {
    return api::guarded(message, [&] {
        const std::shared_ptr<void> ending = std::exchange(api::given(simulation, "simulation").recording, nullptr);
        if (!ending) throw Error(ErrorCode::state, "the recording has ended");
        static_cast<Recording*>(ending.get())->finish(complete != 0);
    });
}

cvtflow_code cvtflow_sweep_run(const char* file, const char* folder, int32_t threads, cvtflow_progress_function function, void* user,
                               cvtflow_message* message) {
    return api::guarded(message, [&] { run_sweep(file, folder, threads, function, user); });
}

cvtflow_code cvtflow_tune(const cvtflow_scene* scene, double accuracy, const char* outputs, double budget, const char* folder,
                          cvtflow_asked_function function, void* user, cvtflow_scene** tuned, cvtflow_tuning* tuning,
                          cvtflow_message* message) {
    return api::guarded(message, [&] {
        TuneOptions options{accuracy, {}, budget, folder != nullptr ? folder : ""};
        std::istringstream names(outputs != nullptr ? outputs : "");
        for (std::string name; std::getline(names, name, ',');) options.outputs.push_back(name);
        auto called = std::chrono::steady_clock::now();
        options.stop = [&] {
            const auto now = std::chrono::steady_clock::now();
            if (function == nullptr || now - called < std::chrono::milliseconds(50)) return false;
            called = now;
            return function(user) != 0;
        };
        cvtflow_scene*& place = api::given(tuned, "tuned");
        const Tuning found = tune(api::given(scene, "scene").scene, options);
        cvtflow_tuning told{sizeof told, found.kept ? 1 : 0, found.error, ""};
        found.choice.copy(told.choice, sizeof told.choice - 1);
        api::fill_versioned(tuning, "tuning", told);
        place = new cvtflow_scene{found.scene};
    });
}

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
