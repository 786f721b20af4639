#pragma once
/// Runs a sweep into a folder, or continues one that was stopped or killed at any moment.
///
///     DIR/cases.h5                 the table, a row per case as it ends, in the order of cases once all are done
///     DIR/checkpoints/case-N.h5    of cases that were running
///     DIR/states/HASH.h5           settled states
///     DIR/records/case-N.h5        records, if the sweep asks for them
///     DIR/workers/0001/            the same for the cases of a worker: those that it has claimed in DIR/workers/claims, or a share that is
///                                  fixed beforehand and needs no claims; merge() makes DIR/cases.h5 of them
///
/// Results do not depend on threads, workers, shares, kills or order. run_batch() itself dies with a case that takes its process down;
/// supervise() starts it again, as the program does.

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "engine/executor/cancellation.hpp"
#include "engine/thread/child_process.hpp"
#include "tasks/batch/results/results.hpp"
#include "tasks/batch/sweep/sweep.hpp"

namespace cvtflow::tasks {

constexpr int max_shards = 100000;

/// Cases of a process: share `number` of `of`, counted from 1, or those that worker `number` claims.
struct Shard {
    int number = 1, of = 1;  ///< `of` is 0 where cases are claimed
    [[nodiscard]] bool whole() const noexcept { return of == 1; }
    [[nodiscard]] bool claims() const noexcept { return of == 0; }
    /// "3/8", "worker 3": an attribute of tables.
    [[nodiscard]] std::string text() const;
    /// @param text  of text(); nothing: not one
    [[nodiscard]] static std::optional<Shard> from(std::string_view text) noexcept;
};

struct BatchProgress {
    long cases = 0, before = 0, done = 0;  ///< cases of this shard: all, done in former sessions, done now
    long failed = 0;                       ///< cases done now, but not ok
    double wall = 0.0;                     ///< [s]
    long warm = 0;                         ///< cases done when every worker had finished one, the shared settling included; 0: not yet
    double warm_wall = 0.0;                ///< wall time when `warm` was set [s]

    /// Time left by the pace since `warm`; NaN before it is set [s].
    [[nodiscard]] double left() const noexcept;
};

/// Work of a child process.
struct SweepPart {
    std::optional<long> only = {};  ///< number of a single case; nothing: all that are not done
    std::string crashed;            ///< reason to record the case as crashed instead of running it; empty: none
    int attempt = 0;                ///< children before this one
};

struct BatchOptions {
    std::string folder;
    int threads = 0;  ///< 0: as many as this process may use
    bool pin = false;
    double grace = 30.0;                     ///< time for running cases to finish after a request to stop; others write a checkpoint [s]
    double checkpoint_every = 60.0;          ///< wall time between checkpoints of a running case [s]
    Shard shard;                             ///< where cases are claimed, the caller holds the place (WorkerPlaces)
    std::vector<std::string> retry;          ///< statuses whose cases run again
    bool mixed = false;                      ///< accepts a table with rows of another program version or another start.state
    bool keep_going = false;                 ///< continues although the first dozen cases failed with the same message
    SweepPart part;                          ///< all, or a single case after a crash
    engine::SharedSlots* journal = nullptr;  ///< one slot per thread; receives the case that each worker runs
    const engine::Cancellation* cancel = nullptr;
    std::function<void(const BatchProgress&)> progress;  ///< called after each case, by one thread at a time
    std::function<void(const std::string&)> notice;      ///< receives warnings (a damaged checkpoint), by one thread at a time
};

struct BatchReport {
    std::string folder;  ///< folder of this shard
    BatchProgress progress;
    CaseTally tally;  ///< statuses of all rows of the table
    bool finished = false;
    std::string results_hash;
    int threads = 0;
    std::string hopeless;            ///< message with which all of the first cases failed, so that no other was begun; empty: none
    std::string continuation_error;  ///< RepeatedCases::text() of continued cases; empty: nothing was continued, or not checked yet
    std::string steady_check;        ///< RepeatedCases::text() of cases that ran three times as long; empty: none
};

/// Runs all cases of the shard that are not in its table yet.
/// @throws engine::RecordError (folder, table; nothing that is in the table is lost), SimulationError (results of another sweep),
/// SceneError
[[nodiscard]] BatchReport run_batch(const Sweep& sweep, const BatchOptions& options);

/// Runs a sweep in children until one has done all of it, so that a case that takes its process down (SIGSEGV, SIGFPE, abort, out of
/// memory) costs one row and not the sweep.
///
///     parent   fork ─► wait ──────────────► dead by a signal: which cases were running? ─► fork …
///     child          └► cases side by side, each noted in the journal while it runs
///
/// After a crash every case that was running continues alone, in a child with one thread: one that also ends this child is recorded
/// as crashed, the others give their results, bit for bit those of an undisturbed sweep. Each crash settles at least one case, so it ends.
/// @param journal  in which the child notes the cases that are running; the slots are its workers
/// @param work  runs in a child until that process ends; must not throw. @return its exit status; 0 of a part with a single case continues
/// the sweep
/// @param said  called in the parent with one line per crash
/// @return exit status of the child that did the whole, or of one that ended by itself otherwise; 130 if a crash came after SIGINT or
/// SIGTERM; 1 for a crash outside of any case
[[nodiscard]] int supervise(engine::SharedSlots& journal, const std::function<int(const SweepPart&)>& work,
                            const std::function<void(const std::string&)>& said);

/// Cases of a shard: whole strands, the most expensive first, each to the shard with the least to do so far. Ascending.
[[nodiscard]] std::vector<long> shard_cases(const Sweep& sweep, const Shard& shard);
/// The folder in which a process writes its rows.
[[nodiscard]] std::string shard_folder(const std::string& folder, const Shard& shard);
/// The shard whose rows a folder contains, by its table; nothing: it has none. @throws engine::RecordError
[[nodiscard]] std::optional<Shard> shard_in(const std::string& folder);

/// The place of a worker: a folder that no other process writes into as long as the lock lives.
struct WorkerPlace {
    int number = 0;
    std::unique_ptr<engine::FolderLock> lock;
};

/// The folders of all workers of a sweep, seen by one of them. A worker is alive as long as its folder is locked. Places of dead workers,
/// with claimed cases that they have not done, are taken over.
class WorkerPlaces {
public:
    /// @throws SimulationError  results of another sweep, or of this one without workers; engine::RecordError
    WorkerPlaces(const Sweep& sweep, const std::string& folder);
    /// A place with cases to run that no other process works in; nothing: there is none now. @throws engine::RecordError
    [[nodiscard]] std::optional<WorkerPlace> next();
    /// Whether all cases are done, as of the last call of next().
    [[nodiscard]] bool done() const noexcept { return done_; }

private:
    [[nodiscard]] bool has_work(int number, const std::vector<engine::Claim>& claims) const;
    const Sweep& sweep_;
    std::string folder_;      ///< folder of the sweep
    std::set<int> finished_;  ///< places whose claimed cases are done
    bool done_ = false;
};

[[nodiscard]] std::string workers_folder(const std::string& folder);
void make_workers_folder(const std::string& folder);  ///< @throws engine::RecordError  cannot be made, a link
[[nodiscard]] std::string claims_file(const std::string& folder);
/// Whether a sweep has cases for workers: its folder contains no table yet, a partial one of merge(), or an unfinished one of a single
/// process.
[[nodiscard]] bool awaits_workers(const std::string& folder);

/// Wall time of a step on one thread, measured on a run's first steps, which are begun again where the run is shorter [s]. Zero if it
/// cannot take one. @param seconds to spend [s]   @param untried why not   @param fault that ended the steps, if one did
[[nodiscard]] double step_wall(const Scene& scene, double seconds, std::string& untried, Fault* fault = nullptr);

/// Estimated cost of a sweep.
struct BatchEstimate {
    double seconds_per_cost = 0.0;  ///< wall time per cost, measured on a few cases [s]
    double total = 0.0;             ///< wall time of all cases of the shard on one thread [s]
    long cases = 0, bad = 0;        ///< bad: parameters that contradict each other
    int measured = 0;               ///< cases that were tried
    double stable_step = 0.0;       ///< the shortest of their largest stable steps; 0: all of them have yet to settle [s]
    double beyond = 0.0;            ///< run.step over that, of the case where it is largest; 0: as above [1]
    std::string untried{};          ///< reason for the last case that could not be measured; empty if all could
};
[[nodiscard]] BatchEstimate estimate(const Sweep& sweep, const Shard& shard, double seconds);  ///< seconds [s]

struct MergeReport {
    std::string file;
    long rows = 0, cases = 0;
    std::vector<std::string> missing_shards;  ///< folders that should be there
    std::vector<long> missing_cases;
    CaseTally tally;
    std::string results_hash;
};

/// Joins the tables of all workers of a folder into DIR/cases.h5.
/// @param partial write the table even if workers or cases are missing; they stay missing, and an attribute names them
/// @param mixed join rows of different versions of the program or starts
/// @throws SimulationError nothing to join; workers of other sweeps, or shares of different divisions; engine::RecordError
[[nodiscard]] MergeReport merge(const std::string& folder, bool partial, bool mixed = false);

/// Progress of the sweep in a folder: of one process or of workers, running or not.
struct FolderProgress {
    /// The folder itself, or that of a worker.
    struct Part {
        std::string folder;
        long done = 0;         ///< cases in its table
        long claimed = 0;      ///< cases that a worker has claimed; otherwise as `done`
        bool running = false;  ///< a process writes into it
    };

    engine::CaseTable head;   ///< attributes and columns of the sweep, no rows
    long cases = 0;           ///< number of cases of the sweep
    CaseTally tally;          ///< statuses of all done cases, each counted once
    std::vector<Part> parts;  ///< empty: the folder contains no table of a sweep

    [[nodiscard]] long running() const noexcept;  ///< number of parts
};

/// Reads all tables of the folder; writes and locks nothing.
/// @throws engine::RecordError  a table that cannot be read; SimulationError  tables of different sweeps
[[nodiscard]] FolderProgress folder_progress(const std::string& folder);

}  // namespace cvtflow::tasks
