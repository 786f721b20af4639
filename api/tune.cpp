#include <cvtflow/tune.hpp>

#include "api/host/translate.hpp"
#include "api/scene/scene_data.hpp"
#include "engine/record/run/schema.hpp"
#include "tasks/scene/units.hpp"
#include "tasks/tuning/tuned_scene.hpp"

namespace cvtflow {
inline namespace v0 {

namespace {

tasks::TuneSettings settings_of(const TuneOptions& options) {
    if (!(options.accuracy > 0.0 && options.accuracy <= 0.5))
        throw Error(ErrorCode::argument, "accuracy: " + tasks::number_text(options.accuracy) + " is outside (0, 0.5]");
    tasks::TuneSettings settings;
    settings.accuracy = options.accuracy;
    settings.outputs = options.outputs;
    settings.budget = options.budget;
    settings.progress = options.progress;
    return settings;
}

}  // namespace

Tuning tune(const Scene& scene, const TuneOptions& options) {
    return api::entered(ErrorCode::scene, [&]() -> Tuning {
        const tasks::TuneSettings settings = settings_of(options);
        const engine::Cancellation cancel(options.stop);
        try {
            tasks::TunedScene tuned =
                tasks::tuned_scene(scene.data_->scene, settings,
                                   options.folder.empty() ? tasks::usual_tuning_folder() : std::filesystem::path(options.folder), cancel);
            const std::string choice = tuned.kept.choice.text();
            return {Scene(std::make_shared<const Scene::Data>(Scene::Data{std::move(tuned.scene)})), choice, tuned.kept.error,
                    !tuned.result};
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
