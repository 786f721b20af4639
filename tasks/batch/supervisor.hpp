#pragma once
/// A sweep in a child process, so that a case that takes its process down (SIGSEGV, SIGFPE, abort, out of memory) costs one row and not the
/// sweep.
///
///     parent   fork ─► wait ──────────────► dead by a signal: which cases were running? ─► fork …
///     child          └► cases side by side, each noted in the journal while it runs
///
/// After a crash every case that was running continues alone, in a child with one thread: one that also ends this child is recorded
/// as crashed, the others give their results, bit for bit those of an undisturbed sweep. Each crash settles at least one case, so it ends.

#include <functional>
#include <optional>
#include <string>

#include "engine/thread/child_process.hpp"

namespace cvtflow::tasks {

/// Work of a child process.
struct SweepPart {
    std::optional<long> only = {};  ///< this case alone; nothing: all that are not done
    std::string crashed;            ///< not to be run but to be booked as crashed, for this reason
    int attempt = 0;                ///< children before this one
};

/// Runs `work` in children until one has done all of the sweep.
/// @param journal  in which the child notes the cases that are running; the slots are its workers
/// @param work  runs in a child until that process ends; must not throw. @return its exit status; 0 of a part with a single case continues
/// the sweep
/// @param said  called in the parent with one line per crash
/// @return exit status of the child that did the whole, or of one that ended by itself otherwise; 130 if a crash came after SIGINT or
/// SIGTERM; 1 for a crash
///         outside of any case
[[nodiscard]] int supervise(engine::SharedSlots& journal, const std::function<int(const SweepPart&)>& work,
                            const std::function<void(const std::string&)>& said);

}  // namespace cvtflow::tasks
