#pragma once
/// A checkpoint, complete for a bitwise continuation: integration, position of its record, and guards against another run.
///
/// The file is a state file (engine/record/run/state_file.hpp): `cvtflow info` reads it, and start.state takes it. It is replaced at once:
/// the former one exists until the new one is on disk.

#include <string>
#include <vector>

#include "engine/record/run/state_file.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow::tasks {

/// Data that a run reports beside its integration.
struct RunHistory {
    bool settled = false;  ///< whether it began with settling
    Counters settling;
    double begin = 0.0;                      ///< simulated time after settling [s]
    double wall = 0.0, settling_wall = 0.0;  ///< wall times up to now [s]
    bool operator==(const RunHistory&) const = default;
    void visit(engine::Archive& archive) {
        archive("settled", settled), archive("run_begin", begin), archive("wall", wall), archive("settling_wall", settling_wall);
        visit_counters(settling, archive);
    }
};

struct Checkpoint : engine::StateHead {
    std::string path;         ///< the scene's file, as it was named
    std::string text;         ///< contents of the scene's file
    std::string record;       ///< absolute path of the run's record; empty: none. A hint for people: it decides about no file
    std::string run;          ///< identity of the run, which its record holds as well; empty: it has no record
    std::string method_hash;  ///< hash of the method's coefficients
    std::string slope_hash;   ///< hash of the right-hand side at the state, which depends on the model and its rounding
    IntegrationState integration;
    RunHistory history;
    std::vector<std::byte> recorder;  ///< RunRecorder::position()

    void visit(engine::Archive& archive) {
        StateHead::visit(archive);
        integration.visit(archive);
        archive("scene_path", path), archive("scene_text", text), archive("record", record);
        archive("run", run), archive("method_hash", method_hash), archive("slope_hash", slope_hash);
        history.visit(archive);
        archive("recorder", recorder);
    }
};

/// The guards for a simulation of this scene at `state`.
void sign(Checkpoint& checkpoint, const Scene& scene, const model::Variator& variator);

/// A checkpoint that engine::write_state() has written. @throws engine::RecordError as read_state_file
[[nodiscard]] Checkpoint read_checkpoint(const std::string& path);
/// Deletes a checkpoint and what a killed writer left of it.
void remove_checkpoint(const std::string& path);

/// The scene of a checkpoint, for resuming it; start.state is ignored. @throws SceneError if this program cannot read it
[[nodiscard]] Scene scene_of(const Checkpoint& checkpoint);

/// Whether a key may change between checkpoint and continuation, since no number before the end depends on it: run.until, budgets, threads
/// …
[[nodiscard]] bool may_change(std::string_view key) noexcept;

/// Refuses to continue a run of another scene, method, model or version of the program.
/// @throws SimulationError, a line per difference:
///     run.checkpoint: this is no checkpoint of the scene:
///       chain.pins = 24, the checkpoint has 84
/// @param mixed  whether another version of the program may continue
void require_same(const std::string& path, const Checkpoint& checkpoint, const Scene& scene, const model::Variator& variator,
                  bool mixed = false);

}  // namespace cvtflow::tasks
