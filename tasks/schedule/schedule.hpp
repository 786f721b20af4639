#pragma once
/// A schedule: how a step is divided into tasks, and the executor: partition x assembly x executor. Results do not depend on it.

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/executor/executor.hpp"
#include "engine/thread/executor_options.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/step/step_graph.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

/// Processors that this process may use: affinity, CPU quota of its cgroup, SLURM_CPUS_PER_TASK.
[[nodiscard]] int usable_threads();
/// Whole processors that the CPU quota of a process's control group (version 2), or of one that it lies in, leaves it; a large number:
/// there is none.
/// @param root where control groups are mounted   @param membership the process's file of groups
[[nodiscard]] int quota_processors(const std::filesystem::path& root, const std::filesystem::path& membership);

struct Schedule {
    std::string executor = "serial";  ///< name in the catalogue of executors
    AssemblyOptions assembly;
    int segments = 1;
    int threads = 1;
    bool balanced = false;  ///< partition by cost of links instead of equal numbers
    engine::Wait wait = engine::Wait::balanced;
    bool pin = false;
    bool present_arena = false;  ///< flow only: in the oneTBB arena of the caller

    bool operator==(const Schedule&) const = default;
    /// "flow, fused, 2 segments, 2 threads"
    [[nodiscard]] std::string text() const;
};

/// Assemblies by name: "fused", "staged", and staged with parts left in one task: "staged-serial-cholesky" (forward and reverse pass),
/// "staged-serial-transition" (detection), "staged-serial-both".
using NamedAssembly = std::pair<const char*, AssemblyOptions>;
[[nodiscard]] std::span<const NamedAssembly> assemblies() noexcept;
[[nodiscard]] std::string assembly_name(const AssemblyOptions& assembly);

/// Schedule of a scene's run settings. Serial with one segment if run.schedule is "auto" (see schedules_for()).
/// Zero segments: as many as threads.
/// @throws SceneError for an unknown executor, with the one that was probably meant
[[nodiscard]] Schedule schedule_of(const RunSettings& run, int links);

/// Executor of a schedule. @throws std::invalid_argument as the catalogue's make
[[nodiscard]] std::unique_ptr<engine::Executor> make_executor(const Schedule& schedule, engine::StampRecorder* recorder = nullptr);

/// Cost of a link relative to a free one, from the cost of a touching link: used by the balanced partition.
struct LinkCosts {
    double free = 1.0;       ///< cost of a link that touches nothing [1]
    double touching = 1.35;  ///< measured at full detail: tips are a third of what else a link costs (bench rhs) [1]
    int grain = 1;           ///< links that are evaluated side by side: segments begin at multiples of it, as long as there are enough
};

/// Cuts of contiguous segments of about equal cost, judged by which links touch now: cuts[0] = 0 < cuts[1] < … < cuts[segments] = links.
/// Allocates nothing. @param phases [4 links]   @param cuts [segments + 1, out]
void balance(const std::vector<model::Phase>& phases, std::span<int> cuts, const LinkCosts& costs) noexcept;
/// Cost of the most costly segment between such cuts.
[[nodiscard]] double longest_segment(const std::vector<model::Phase>& phases, std::span<const int> cuts, const LinkCosts& costs) noexcept;

/// Candidate schedules of a scene: run.schedule, or, if that is "auto", serial and then `flow` on two threads … a quarter, a half and all
/// of them, with a segment each. Segments, assembly and partition that the scene gives are respected; of threads there are at most as many
/// as it gives. Only serial on one usable processor.
/// @throws SceneError for an executor that does not exist
[[nodiscard]] std::vector<Schedule> schedules_for(const Scene& scene);

/// Segments, and with them threads, that a step of this machine can be cut into: rigid pins are one, everything else as many as links.
[[nodiscard]] int max_segments(const model::Parameters& parameters) noexcept;

}  // namespace cvtflow::tasks
