#pragma once
/// A TbbSection whose threads may be pinned by their slot. The compared executors identify a thread by its slot alone.

#include <oneapi/tbb/task_scheduler_observer.h>

#include <memory>
#include <optional>

#include "engine/executor/tbb/tbb_section.hpp"
#include "engine/thread/executor_options.hpp"
#include "engine/thread/pinning.hpp"

namespace cvtflow::bench {

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
    engine::Processors processors_;
    int slots_;
    std::unique_ptr<Guest[]> guests_;
};

/// A separate arena; with `pin`, threads are pinned by their slot.
class PinnedSection : public engine::TbbSection {
public:
    explicit PinnedSection(const engine::ExecutorOptions& options) : TbbSection(options.threads) {
        if (options.pin) pins_.emplace(*own_arena(), options.threads);
    }

private:
    std::optional<ArenaPins> pins_;
};

/// The calling thread's track: its slot in the arena, 0 … threads - 1.
[[nodiscard]] inline int slot() noexcept { return oneapi::tbb::this_task_arena::current_thread_index(); }

}  // namespace cvtflow::bench
