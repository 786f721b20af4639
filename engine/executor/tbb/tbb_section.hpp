#pragma once
/// The part of a process' oneTBB that belongs to one run. Private to this folder.

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>
#include <oneapi/tbb/task_scheduler_observer.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "engine/thread/executor_options.hpp"
#include "engine/thread/pinning.hpp"
#include "engine/thread/worker_threads.hpp"

namespace cvtflow::engine {

/// Pins threads while they are in an arena: thread in slot i to the i-th processor.
class ArenaPins final : public oneapi::tbb::task_scheduler_observer {
public:
    ArenaPins(oneapi::tbb::task_arena& arena, int slots);
    /// Restores the masks of all threads, also of those that have not left yet and would now leave unobserved.
    ~ArenaPins() override;
    ArenaPins(const ArenaPins&) = delete;
    ArenaPins& operator=(const ArenaPins&) = delete;

    void on_scheduler_entry(bool worker) override;
    void on_scheduler_exit(bool worker) override;

private:
    struct Guest;  // a thread in a slot
    Processors processors_;
    int slots_;
    std::unique_ptr<Guest[]> guests_;
};

/// An own arena and an own context: neither do our threads run the host's tasks while they wait, nor the host's threads ours, nor does
/// a host that cancels its tasks cancel the step. (A default flow::graph of oneTBB 2021.8 is bound to the host's context.)
/// The context carries the caller's floating point mode to all threads. A graph is built inside execute(), for it belongs to the arena
/// in which it is built.
///
/// Or the arena in which the caller already is, isolated: the caller takes none of the host's tasks while it waits.
///
/// If the system has fewer threads than requested, a separate arena with the available ones is used, down to the caller alone.
class TbbSection {
public:
    /// @param pin whether threads are pinned by their slot
    TbbSection(int threads, bool pin) : TbbSection(threads, pin, false) {}
    explicit TbbSection(const ExecutorOptions& options) : TbbSection(options.threads, false, options.present_arena) {}

    /// Calls action(context) in the arena; the calling thread has the slot reserved for it.
    template <class Action>
    void execute(Action&& action) {
        if (arena_) {
            arena_->execute([&] { action(context_); });
        } else {
            oneapi::tbb::this_task_arena::isolate([&] { action(context_); });
        }
    }

private:
    TbbSection(int threads, bool pin, bool present);

    /// Has oneTBB start its workers while a refusal is an exception and no more.
    void try_workers();

    /// More never come, and oneTBB would complain on the host's standard error.
    [[nodiscard]] static int max_threads() {
        return static_cast<int>(oneapi::tbb::global_control::active_value(oneapi::tbb::global_control::max_allowed_parallelism));
    }

    WorkerGrant grant_;
    std::optional<oneapi::tbb::task_arena> arena_;  // none: the caller's
    oneapi::tbb::task_group_context context_{oneapi::tbb::task_group_context::isolated, oneapi::tbb::task_group_context::default_traits |
                                                                                            oneapi::tbb::task_group_context::fp_settings};
    std::unique_ptr<ArenaPins> pins_;
};

/// The calling thread's track: its slot in the arena, 0 … threads - 1.
[[nodiscard]] inline int slot() noexcept { return oneapi::tbb::this_task_arena::current_thread_index(); }

}  // namespace cvtflow::engine
