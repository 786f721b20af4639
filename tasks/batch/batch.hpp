#pragma once
/// Runs a sweep into a folder (tasks/batch/results/results.hpp), together with every other process that runs it there, or continues one
/// that was stopped or killed at any moment.
///
///     DIR/states/HASH.state        settled states
///     DIR/records/case-N.h5        records, if the sweep asks for them
///     DIR/continuation/end-N.h5    ends of continued cases, from which their neighbours start
///
/// Results do not depend on threads, processes, kills or order. run_batch() itself dies with a case that takes its process down;
/// supervise() starts it again, as the program does.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/executor/cancellation.hpp"
#include "engine/thread/child_process.hpp"
#include "tasks/batch/results/results.hpp"
#include "tasks/batch/sweep/sweep.hpp"

namespace cvtflow::tasks {

struct BatchProgress {
    long cases = 0, before = 0, done = 0;  ///< all cases, those done by others or before, those done here and now
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
    double grace = 30.0;                     ///< time for running cases to finish after a request to stop; others begin anew later [s]
    double silence = 120.0;                  ///< time after which a process without a sign of life counts as lost [s]
    std::vector<std::string> retry;          ///< statuses whose cases run again
    bool keep_going = false;                 ///< continues although the first dozen cases failed with the same message
    SweepPart part;                          ///< all, or a single case after a crash
    engine::SharedSlots* journal = nullptr;  ///< one slot per thread; receives the case that each worker runs
    const engine::Cancellation* cancel = nullptr;
    std::function<void(const BatchProgress&)> progress;  ///< called after each case, by one thread at a time
    std::function<void(const std::string&)> notice;      ///< receives warnings (damaged rows, waiting), by one thread at a time
};

struct BatchReport {
    std::string folder;
    BatchProgress progress;
    CaseTally tally;  ///< statuses of all rows
    bool finished = false;
    std::string results_hash;
    int threads = 0;
    std::string hopeless;            ///< message with which all of the first cases failed, so that no other was begun; empty: none
    std::string continuation_error;  ///< RepeatedCases::text() of continued cases; empty: nothing was continued, or not checked yet
    std::string steady_check;        ///< RepeatedCases::text() of cases that ran three times as long; empty: none
};

/// Runs all cases that have no row yet, and waits for those of other processes. The process that ends it writes DIR/results.csv.
/// @throws engine::RecordError (folder, rows; no row is lost), SimulationError (results of another sweep), SceneError
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

/// Wall time of a step on one thread, measured on a run's first steps, which are begun again where the run is shorter [s]. Zero if it
/// cannot take one. @param seconds to spend [s]   @param untried why not   @param fault that ended the steps, if one did
[[nodiscard]] double step_wall(const Scene& scene, double seconds, std::string& untried, Fault* fault = nullptr);

/// Estimated cost of a sweep.
struct BatchEstimate {
    double seconds_per_cost = 0.0;  ///< wall time per cost, measured on a few cases [s]
    double total = 0.0;             ///< wall time of all cases on one thread [s]
    long cases = 0, bad = 0;        ///< bad: parameters that contradict each other
    int measured = 0;               ///< cases that were tried
    double stable_step = 0.0;       ///< the shortest of their largest stable steps; 0: all of them have yet to settle [s]
    double beyond = 0.0;            ///< run.step over that, of the case where it is largest; 0: as above [1]
    std::string untried{};          ///< reason for the last case that could not be measured; empty if all could
};
[[nodiscard]] BatchEstimate estimate(const Sweep& sweep, double seconds);  ///< seconds [s]

}  // namespace cvtflow::tasks
