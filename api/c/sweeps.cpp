/// The C interface to sweeps and tuning.

#include <chrono>
#include <filesystem>
#include <sstream>
#include <string>
#include <utility>

#include "api/c/boundary.hpp"
#include "engine/executor/cancellation.hpp"
#include "engine/record/run/schema.hpp"
#include "tasks/batch/batch.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tasks/scene/units.hpp"
#include "tasks/tuning/tuned_scene.hpp"
#include "tasks/tuning/verified_sweep.hpp"

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

/// Runs the cases that are missing in the folder; tuned before and verified after, where the sweep has an accuracy.
/// @return whether all cases are in the table; false after a cancellation   @throws Error (record, state, argument)
bool run_cases(const tasks::Sweep& sweep, const std::string& folder, int threads, engine::Cancellation& cancel,
               std::function<void(const tasks::BatchProgress&)> progress) {
    return api::translated(ErrorCode::record, [&] {
        api::require_threads(threads, 0);
        tasks::BatchOptions options;
        options.folder = folder;
        options.threads = threads > 0 ? threads : tasks::usable_threads();
        options.grace = 0.0;
        options.cancel = &cancel;
        options.progress = std::move(progress);
        try {
            const tasks::TunedSweep tuned = tasks::tuned_sweep(sweep, folder, cancel, {});
            const tasks::BatchReport report = tasks::run_batch(tuned.sweep, options);
            if (!report.hopeless.empty()) throw tasks::SimulationError(report.hopeless);
            if (report.finished && sweep.accuracy.target > 0.0)
                static_cast<void>(tasks::verify_sweep(sweep, tuned, report.folder, cancel, {}));
            cancel.withdraw();
            return report.finished;
        } catch (const tasks::SimulationError& error) {
            if (cancel.withdraw()) return false;  // while it was tuned or verified
            throw Error(ErrorCode::state, error.what());
        }
    });
}

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
    const bool finished = run_cases(sweep, folder, threads, cancel, [&](const tasks::BatchProgress& now) {
        if (progress.report(now)) cancel.request();
    });
    if (!finished) throw Error(ErrorCode::cancelled, "cancelled");
}

/// @param outputs separated by commas   @throws Error (argument)
tasks::TuneSettings settings_of(double accuracy, const char* outputs, double budget) {
    if (!(accuracy > 0.0 && accuracy <= 0.5))
        throw Error(ErrorCode::argument, "accuracy: " + tasks::number_text(accuracy) + " is outside (0, 0.5]");
    tasks::TuneSettings settings;
    settings.accuracy = accuracy;
    settings.budget = budget;
    std::istringstream names(outputs);
    for (std::string name; std::getline(names, name, ',');) settings.outputs.push_back(name);
    return settings;
}

}  // namespace

extern "C" {

cvtflow_code cvtflow_sweep_run(const char* file, const char* folder, int32_t threads, cvtflow_progress_function function, void* user,
                               cvtflow_message* message) {
    return api::guarded(message, [&] { run_sweep(file, folder, threads, function, user); });
}

cvtflow_code cvtflow_tune(const cvtflow_scene* scene, double accuracy, const char* outputs, double budget, const char* folder,
                          cvtflow_asked_function function, void* user, cvtflow_scene** tuned, cvtflow_tuning* tuning,
                          cvtflow_message* message) {
    const auto action = [&] {
        const tasks::TuneSettings settings = settings_of(accuracy, outputs != nullptr ? outputs : "", budget);
        auto called = std::chrono::steady_clock::now();
        const std::function<bool()> asked = [&] {
            const auto now = std::chrono::steady_clock::now();
            if (function == nullptr || now - called < between_calls) return false;
            called = now;
            return function(user) != 0;
        };
        const engine::Cancellation cancel(asked);
        const bool own = folder != nullptr && *folder != '\0';
        cvtflow_scene*& place = api::given(tuned, "tuned");
        try {
            tasks::TunedScene found = tasks::tuned_scene(api::given(scene, "scene").scene(), settings,
                                                         own ? std::filesystem::path(folder) : tasks::usual_tuning_folder(), cancel);
            cvtflow_tuning chosen{sizeof chosen, found.result ? 0 : 1, found.kept.error, ""};
            found.kept.choice.text().copy(chosen.choice, sizeof chosen.choice - 1);
            api::fill_versioned(tuning, "tuning", chosen);
            place = new cvtflow_scene{std::make_shared<const api::SceneData>(std::move(found.scene))};
        } catch (const engine::RecordError& error) {
            throw Error(ErrorCode::start_state, error.what());
        } catch (const tasks::SimulationError& error) {
            if (cancel.requested()) throw Error(ErrorCode::cancelled, "the tuning was cancelled");
            throw Error(ErrorCode::state, error.what());
        }
    };
    return api::guarded(message, action, ErrorCode::scene);
}

}  // extern "C"
