/// Files of a case while it runs: its checkpoint, and its end state for the neighbour that starts there.

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "tasks/batch/case_engine.hpp"
#include "tasks/batch/results/sweep_files.hpp"
#include "tasks/run/checkpoint.hpp"
#include "tasks/run/saved_start.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

std::string case_file(const std::filesystem::path& folder, std::string_view kind, long number) {
    return (folder / fmt::format("{}-{:06}.h5", kind, number)).string();
}

std::string CaseEngine::checkpoint_file() const { return case_file(places_.checkpoints, own_start_ ? "check" : "case", result_.number); }

void CaseEngine::save() {
    if (places_.checkpoints.empty()) return;
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
    begin(nullptr);
    record_options_.from = nullptr;
    at_->simulation.restore(checkpoint.integration);
    window_steps_ = checkpoint.integration.counters.steps;
    history_ = checkpoint.history;
    wall_before_ = checkpoint.history.wall;
    const auto memory = scalars_.load(checkpoint.recorder, checkpoint.integration.time);
    if (recorder_) recorder_->restore({memory.begin(), memory.end()});
}

namespace {

std::string end_file(const CasePlaces& places, long strand, long parity) {
    return (places.continuation / fmt::format("strand-{:06}-{}.h5", strand, parity)).string();
}

/// The case whose end a state is, if any.
std::optional<double> case_of(const engine::SavedState& end) {
    if (end.more.empty() || end.more.front().values.empty()) return {};
    return end.more.front().values.front();
}

bool end_is_kept(const CasePlaces& places, long strand, long number) {
    const std::string file = end_file(places, strand, number % 2);
    std::error_code missing;
    return std::filesystem::exists(file, missing) && case_of(engine::read_state(file)) == static_cast<double>(number);
}

}  // namespace

void reopen_broken_strands(const Sweep& sweep, const CasePlaces& places, const std::vector<long>& ok, std::vector<char>& done) {
    const long length = sweep.strand();
    for (long first = 0; length > 1 && first < sweep.cases(); first += length) {
        const auto begin = done.begin() + first, end = begin + length, open = std::find(begin, end, 0);
        const auto last = std::lower_bound(ok.begin(), ok.end(), first + length);
        const bool from_a_case = last != ok.begin() && last[-1] >= first;
        const bool only_the_last_are_open = std::find(open, end, 1) == end;
        if (open == end || (only_the_last_are_open && (!from_a_case || end_is_kept(places, first / length, last[-1])))) continue;
        std::fill(begin, end, char{0});
    }
}

/// Ends alternate between two files, so that a case that was lost with a killed process finds the end before it. The end that a case starts
/// from is kept until the case has one.
StartStates::State end_before(const Sweep& sweep, const CasePlaces& places, long number, const Scene& scene) {
    const long first = number - number % sweep.strand();
    StartStates::State latest;
    std::optional<double> newest;
    for (int parity = 0; parity < 2 && sweep.strand() > 1 && number > first; ++parity) {
        const std::string file = end_file(places, first / sweep.strand(), parity);
        std::error_code missing;
        if (!std::filesystem::exists(file, missing)) continue;
        auto state = std::make_shared<engine::SavedState>(engine::read_state(file));
        const std::optional<double> ended = case_of(*state);
        if (!ended || *ended >= static_cast<double>(number) || ended <= newest) continue;
        newest = ended;
        latest = std::move(state);
    }
    return latest && start_fits(*latest, scene) ? latest : nullptr;
}

void keep_for_neighbour(const Sweep& sweep, const CasePlaces& places, long number, const Scene& scene, Simulation& simulation) {
    if (sweep.strand() == 1) return;
    simulation.move_offset();
    engine::SavedState saved = simulation.saved_state();
    turn_shaft(saved, scene.parameters, 0, -scene.parameters.drive.speed.integral(saved.time));
    saved.time = 0.0;
    saved.more = {{"case", {static_cast<double>(number)}}};
    std::filesystem::create_directories(places.continuation);
    const long strand = number / sweep.strand();
    engine::write_state(permit_state(end_file(places, strand, number % 2), sweep), saved);
}

}  // namespace cvtflow::tasks
