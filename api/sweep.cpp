#include <cvtflow/sweep.hpp>

#include "api/host/translate.hpp"
#include "engine/record/run/schema.hpp"
#include "tasks/batch/batch.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tasks/tuning/verified_sweep.hpp"

namespace cvtflow {
inline namespace v0 {

struct Sweep::Impl {
    tasks::Sweep sweep;
    engine::Cancellation cancel{};

    explicit Impl(tasks::Sweep read) : sweep(std::move(read)) {}

    [[nodiscard]] tasks::BatchReport run(const std::string& folder, int threads, std::function<void(const SweepProgress&)> progress) {
        constexpr int max_threads = 1024;
        if (threads < 0 || threads > max_threads)
            throw Error(ErrorCode::argument, "threads: " + std::to_string(threads) + " is outside [0, 1024]");
        tasks::BatchOptions options;
        options.folder = folder;
        options.threads = threads > 0 ? threads : tasks::usable_threads();
        options.grace = 0.0;
        options.cancel = &cancel;
        if (progress) {
            options.progress = [call = std::move(progress)](const tasks::BatchProgress& now) {
                call({now.cases, now.before, now.done, now.failed, now.wall});
            };
        }
        try {
            const tasks::TunedSweep tuned = tasks::tuned_sweep(sweep, folder, cancel, {});
            const tasks::BatchReport report = tasks::run_batch(tuned.sweep, options);
            if (!report.hopeless.empty()) throw tasks::SimulationError(report.hopeless);
            if (report.finished && sweep.accuracy.target > 0.0)
                static_cast<void>(tasks::verify_sweep(sweep, tuned, report.folder, cancel, {}));
            return report;
        } catch (const tasks::SimulationError& error) {
            if (cancel.requested()) return {};  // while it was tuned or verified
            throw Error(ErrorCode::state, error.what());
        }
    }
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
    return api::entered(ErrorCode::record, [&] {
        const tasks::BatchReport report = impl_->run(folder, threads, std::move(progress));
        impl_->cancel.withdraw();
        return report.finished;
    });
}

}  // namespace v0
}  // namespace cvtflow
