#include <cvtflow/sweep.hpp>
#include <cvtflow/tune.hpp>

#include "api/simulation_impl.hpp"
#include "api/sweep_run.hpp"
#include "engine/record/run/schema.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tasks/scene/units.hpp"
#include "tasks/tuning/tuned_scene.hpp"
#include "tasks/tuning/verified_sweep.hpp"

namespace cvtflow {

bool api::run_sweep(const tasks::Sweep& sweep, const std::string& folder, int threads, engine::Cancellation& cancel,
                    std::function<void(const tasks::BatchProgress&)> progress) {
    return entered(ErrorCode::record, [&] {
        require_threads(threads, 0);
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

inline namespace v0 {

struct Sweep::Impl {
    tasks::Sweep sweep;
    engine::Cancellation cancel{};

    explicit Impl(tasks::Sweep read) : sweep(std::move(read)) {}
};

Sweep::Sweep(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
Sweep::~Sweep() = default;
Sweep::Sweep(Sweep&& other) noexcept = default;
Sweep& Sweep::operator=(Sweep&& other) noexcept = default;

Sweep Sweep::read(const std::string& path) {
    return api::entered(ErrorCode::scene, [&] { return Sweep(std::make_unique<Impl>(tasks::read_sweep(path, tasks::find_scene))); });
}

const std::string& Sweep::name() const noexcept { return impl_->sweep.name; }
long Sweep::cases() const noexcept { return impl_->sweep.cases(); }
void Sweep::cancel() noexcept { impl_->cancel.request(); }

bool Sweep::run(const std::string& folder, int threads, std::function<void(const SweepProgress&)> progress) {
    return api::run_sweep(impl_->sweep, folder, threads, impl_->cancel, [&](const tasks::BatchProgress& now) {
        if (progress) progress({now.cases, now.before, now.done, now.failed, now.wall});
    });
}

Tuning tune(const Scene& scene, const TuneOptions& options) {
    return api::entered(ErrorCode::scene, [&]() -> Tuning {
        if (!(options.accuracy > 0.0 && options.accuracy <= 0.5))
            throw Error(ErrorCode::argument, "accuracy: " + tasks::number_text(options.accuracy) + " is outside (0, 0.5]");
        tasks::TuneSettings settings;
        settings.accuracy = options.accuracy;
        settings.outputs = options.outputs;
        settings.budget = options.budget;
        settings.progress = options.progress;
        const engine::Cancellation cancel(options.stop);
        try {
            tasks::TunedScene tuned =
                tasks::tuned_scene(scene.data_->scene, settings,
                                   options.folder.empty() ? tasks::usual_tuning_folder() : std::filesystem::path(options.folder), cancel);
            const std::string choice = tuned.kept.choice.text();
            return {Scene(std::make_shared<const Scene::Data>(std::move(tuned.scene))), choice, tuned.kept.error, !tuned.result};
        } catch (const engine::RecordError& error) {
            throw Error(ErrorCode::start_state, error.what());
        } catch (const tasks::SimulationError& error) {
            if (cancel.requested()) throw Error(ErrorCode::cancelled, "the tuning was cancelled");
            throw Error(ErrorCode::state, error.what());
        }
    });
}

}  // namespace v0
}  // namespace cvtflow
