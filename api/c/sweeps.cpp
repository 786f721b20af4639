/// The C interface to sweeps.

#include <chrono>
#include <string>
#include <utility>

#include "api/c/boundary.hpp"
#include "engine/executor/cancellation.hpp"
#include "tasks/batch/batch.hpp"
#include "tasks/scene/ready_scenes.hpp"

using namespace cvtflow;

namespace {

constexpr std::chrono::milliseconds between_calls{50};  ///< of a host's function while cases step

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
        const bool ends = mutex_.guard([&] { return Clock::now() - called_ >= between_calls && call(); });
        alone_.leave();
        return ends;
    }

private:
    using Clock = std::chrono::steady_clock;

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

/// Runs the cases that are missing in the folder.
/// @return whether all cases are in the table; false after a cancellation   @throws Error (record, state, argument)
bool run_cases(const tasks::Sweep& sweep, const std::string& folder, int threads, bool keep_going, engine::Cancellation& cancel,
               std::function<void(const tasks::BatchProgress&)> progress) {
    return api::translated(ErrorCode::record, [&] {
        api::require_threads(threads, 0);
        tasks::BatchOptions options;
        options.folder = folder;
        options.threads = threads > 0 ? threads : tasks::usable_threads();
        options.grace = 0.0;
        options.keep_going = keep_going;
        options.cancel = &cancel;
        options.progress = std::move(progress);
        if (sweep.accuracy.target > 0.0) throw Error(ErrorCode::argument, sweep.name + ": cvtflow batch runs a sweep with [accuracy]");
        try {
            const tasks::BatchReport report = tasks::run_batch(sweep, options);
            if (!report.hopeless.empty()) throw tasks::SimulationError(report.hopeless);
            cancel.withdraw();
            return report.finished;
        } catch (const tasks::SimulationError& error) {
            throw Error(ErrorCode::state, error.what());
        }
    });
}

void run_sweep(const char* file, const char* folder, int threads, bool keep_going, cvtflow_progress_function function, void* user) {
    const tasks::Sweep sweep =
        api::entered(ErrorCode::scene, [&] { return tasks::read_sweep(&api::given(file, "file"), tasks::find_scene); });
    Progress progress(function, user, sweep.cases());
    const std::function<bool()> asked = [&progress] { return progress.ask(); };
    engine::Cancellation cancel(asked);
    if (progress.report({}) || folder == nullptr) {
        if (folder == nullptr) return;
        throw Error(ErrorCode::cancelled, "cancelled");
    }
    const bool finished = run_cases(sweep, folder, threads, keep_going, cancel, [&](const tasks::BatchProgress& now) {
        if (progress.report(now)) cancel.request();
    });
    if (!finished) throw Error(ErrorCode::cancelled, "cancelled");
}

}  // namespace

extern "C" {

cvtflow_code cvtflow_sweep_run(const char* file, const char* folder, int32_t threads, int32_t keep_going,
                               cvtflow_progress_function function, void* user, cvtflow_message* message) {
    return api::guarded(message, [&] { run_sweep(file, folder, threads, keep_going != 0, function, user); });
}

}  // extern "C"
