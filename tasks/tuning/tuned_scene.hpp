#pragma once
/// A scene with the choice that a Tuner made for it: as a scene to run, as a file, and kept by content for the next time.

#include <filesystem>
#include <optional>
#include <string>

#include "tasks/tuning/tuner.hpp"

namespace cvtflow::tasks {

/// No choice meets the target.
class AccuracyError : public SimulationError {
public:
    explicit AccuracyError(const std::string& what, bool early = false) : SimulationError(what), used_up_budget(early) {}
    bool used_up_budget;  ///< the search ended early, so that choices remain untried
};

/// A choice as it is kept.
struct KeptTuning {
    TuneChoice choice;
    double step = 0.0;   ///< 0: automatic [s]
    double error = 0.0;  ///< largest that was measured [1]
};

/// Default folder of the cache: $XDG_CACHE_HOME/cvtflow, else ~/.cache/cvtflow; empty: no cache.
[[nodiscard]] std::filesystem::path usual_tuning_folder();

/// Hash of everything that a choice depends on: scene with start state, tuning settings, program and instruction set.
[[nodiscard]] std::string tuning_key(const Scene& scene, const TuneSettings& settings);

/// The cached choice of a key; empty if missing, damaged or of another key.
[[nodiscard]] std::optional<KeptTuning> read_tuning(const std::filesystem::path& folder, const std::string& key);
/// Keeps it. A folder that cannot be written to is no error: the next time it is measured again.
void keep_tuning(const std::filesystem::path& folder, const std::string& key, const KeptTuning& kept);

struct TunedScene {
    Scene scene;  ///< ready to run
    KeptTuning kept;
    std::optional<TuneResult> result;  ///< result of a search; nothing: the choice was kept from before
};

/// The choice of a key: as kept, else found by a search and kept. @param result  in, out: of the search   @throws AccuracyError, as Tuner
[[nodiscard]] KeptTuning kept_or_found(const std::filesystem::path& folder, const std::string& key,
                                       const std::function<TuneResult()>& search, std::optional<TuneResult>& result);

/// The scene as it should be run for an accuracy: as written but for detail, method and step, which are as kept, else measured and kept.
/// It begins where its errors were measured: with the scene's state; where that has other unknowns than the chosen detail, with the state
/// of the chosen detail that was measured, kept beside the choice; without a state that fits it settles for start.settling_time.
/// @param folder where; one that cannot be written to keeps nothing, and the scene settles instead of taking a kept state
/// @throws AccuracyError, as Tuner
[[nodiscard]] TunedScene tuned_scene(const Scene& scene, const TuneSettings& settings, const std::filesystem::path& folder,
                                     const engine::Cancellation& cancel);

/// The chosen one. @throws AccuracyError: none was; the message names the nearest one
[[nodiscard]] const TunedChoice& chosen_of(const TuneResult& result);

/// Whether a scene needs another start state at that detail: it has none, or one with other unknowns.
[[nodiscard]] bool needs_own_state(const Scene& scene, const Scene& chosen);

/// The chosen scene as a file with every key; what was measured and how, in comments.
/// @param state_file of the start, empty: as the scene has it   @throws AccuracyError
[[nodiscard]] std::string tuned_text(const Scene& scene, const TuneResult& result, const std::string& state_file);

}  // namespace cvtflow::tasks
