/// Checkpoint of a case while it runs.

#include <fmt/format.h>

#include <utility>

#include "tasks/batch/case_engine.hpp"
#include "tasks/batch/results/sweep_files.hpp"
#include "tasks/run/checkpoint.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

std::string case_file(const std::filesystem::path& folder, std::string_view kind, long number) {
    return (folder / fmt::format("{}-{:06}.h5", kind, number)).string();
}

std::string CaseEngine::checkpoint_file() const {
    return case_file(places_.checkpoints, own_start_ ? "check" : plain_ ? "plain" : "case", result_.number);
}

void CaseEngine::save() {
    Checkpoint checkpoint;
    checkpoint.integration = at_->simulation.integration_state();
    checkpoint.history = history_;
    checkpoint.history.wall = elapsed();
    scalars_.save(checkpoint.recorder);
    if (recorder_) {
        checkpoint.run = recorder_->run();
        const std::vector<double> position = recorder_->position();
        checkpoint.recorder.insert(checkpoint.recorder.end(), position.begin(), position.end());
    }
    sign(checkpoint, scene_, at_->simulation.workspace().variator);
    std::filesystem::create_directories(places_.checkpoints);
    write_checkpoint(permit_state(checkpoint_file(), sweep_), checkpoint);
    last_save_ = std::chrono::steady_clock::now();
    on_disk_ = true;
}

void CaseEngine::forget_checkpoint() {
    if (std::exchange(on_disk_, false)) remove_checkpoint(checkpoint_file());
}

/// Puts the case to where its checkpoint was taken, if it has one. A checkpoint that is damaged, or does not fit any more, is passed over:
/// the case begins anew, with the same result.
bool CaseEngine::restore() {
    std::error_code missing;
    if (!resumable_ || !std::filesystem::exists(checkpoint_file(), missing)) return false;
    std::string why;
    try {
        resume_from(read_checkpoint(checkpoint_file()));
    } catch (const std::runtime_error& damaged) {  // engine::RecordError, SimulationError, SceneError
        why = damaged.what();
    } catch (const std::invalid_argument& of_another_method) {
        why = of_another_method.what();
    }
    if (!why.empty()) {
        control_.tell(fmt::format("case {} restarts: its checkpoint cannot be used: {}", result_.number, why));
        prepare();
        std::filesystem::remove(case_file(places_.records, "case", result_.number) + ".before", missing);
    }
    on_disk_ = true;
    return why.empty();
}

void CaseEngine::resume_from(const Checkpoint& checkpoint) {
    record_options_.from = &checkpoint;
    begin({});
    record_options_.from = nullptr;
    at_->simulation.restore(checkpoint.integration);
    window_steps_ = checkpoint.integration.counters.steps;
    history_ = checkpoint.history;
    wall_before_ = checkpoint.history.wall;
    const auto memory = scalars_.load(checkpoint.recorder, checkpoint.integration.time);
    if (recorder_) recorder_->restore({memory.begin(), memory.end()});
}

}  // namespace cvtflow::tasks
