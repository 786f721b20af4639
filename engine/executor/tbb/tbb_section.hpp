#pragma once
/// The part of a process' oneTBB that belongs to one run. Private to this folder.

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <algorithm>
#include <exception>
#include <optional>

#include "engine/thread/worker_threads.hpp"

namespace cvtflow::engine {

/// A separate arena and context: neither do our threads run the host's tasks while they wait, nor the host's threads ours, nor does a host
/// that cancels its tasks cancel the step. (A default flow::graph of oneTBB 2021.8 is bound to the host's context.) The context carries the
/// caller's floating point mode to all threads. A graph is built inside execute(), for it belongs to the arena in which it is built.
///
/// Or the arena in which the caller already is, isolated: the caller takes none of the host's tasks while it waits.
///
/// If the system has fewer threads than requested, a separate arena with the available ones is used, down to the caller alone.
class TbbSection {
public:
    /// @param present whether it is the arena of the caller
    explicit TbbSection(int threads, bool present = false) : grant_(std::min(threads, std::max(1, max_threads()))) {
        if (!present || grant_.threads() < std::min(threads, max_threads())) arena_.emplace(grant_.threads(), 1);
        if (grant_.fresh()) try_workers();
    }

    /// Calls action(context) in the arena; the calling thread has the slot reserved for it.
    template <class Action>
    void execute(Action&& action) {
        if (arena_) {
            arena_->execute([&] { action(context_); });
        } else {
            oneapi::tbb::this_task_arena::isolate([&] { action(context_); });
        }
    }

protected:
    /// Arena of this section; nothing: the caller's.
    [[nodiscard]] std::optional<oneapi::tbb::task_arena>& own_arena() noexcept { return arena_; }

private:
    /// Has oneTBB start its workers while a refusal is an exception and no more.
    void try_workers() {
        try {
            execute([&](oneapi::tbb::task_group_context& context) {
                oneapi::tbb::parallel_for(
                    0, grant_.threads(), [](int) {}, oneapi::tbb::simple_partitioner(), context);
            });
        } catch (const std::exception&) {
            grant_.refused();
            context_.reset();
            arena_.emplace(1, 1);
        }
    }

    /// Threads that oneTBB permits. A request for more gets no more, and a message on the host's standard error.
    [[nodiscard]] static int max_threads() {
        return static_cast<int>(oneapi::tbb::global_control::active_value(oneapi::tbb::global_control::max_allowed_parallelism));
    }

    WorkerGrant grant_;
    std::optional<oneapi::tbb::task_arena> arena_;  // none: the caller's
    oneapi::tbb::task_group_context context_{oneapi::tbb::task_group_context::isolated, oneapi::tbb::task_group_context::default_traits |
                                                                                            oneapi::tbb::task_group_context::fp_settings};
};

}  // namespace cvtflow::engine
