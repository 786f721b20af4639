#include "bench/executor/compared_executors.hpp"

#include <cstdint>
#include <exception>
#include <memory>
#include <thread>
#include <vector>

#include "engine/thread/backoff.hpp"
#include "engine/thread/pinning.hpp"
#include "engine/thread/worker_threads.hpp"

namespace cvtflow::bench {

using namespace engine;

namespace {

/// A team of std::jthreads that meets at a barrier after every level: the simplest of the parallel executors, and the one that
/// ThreadSanitizer can check. It exists during a run; the calling thread is its first member and the only one that calls the controller. It
/// runs without threads that the system refuses to start.
///
/// Proof that this is free of races: one level at a time is open. The caller C writes what the level is, then stores its number to
/// `opened`; a worker W loads that number, runs its share, then stores the number to its `done`; C loads every `done`.
///
///     C   level_ = …; opened ◄─ 7 ······ share ······ done[1] = 7? ─► controller, level_ = …; opened ◄─ 8
///                          │ release/acquire           ▲ acquire/release
///     W                    └──► reads level_, share ···┴─ done[1] ◄─ 7          opened = 8? …
///
/// Every store is a release and every load of another's number an acquire, so all that C and the workers wrote before level 7 is
/// seen in level 7, and all that was read or written in level 7 is complete before C continues. level_ is written only while every worker
/// waits for `opened`. Each number has one writer and grows by one, hence no reset, no compare-and-swap and nothing to wrap (64 bits).
class Team {
public:
    Team(Run& run, const ExecutorOptions& options) : run_(run), options_(options), untried_(options), own_(options.pin, processors_, 0) {
        const auto requested = static_cast<std::size_t>(options.threads);
        done_ = std::make_unique<Counter[]>(requested);
        threads_.reserve(requested);
        try {
            for (int worker = 1; worker < options.threads; ++worker) threads_.emplace_back([this, worker] { work(worker); });
        } catch (const std::exception&) {
            // The system has no more threads for us: those that began suffice.
        }
        members_ = static_cast<int>(threads_.size()) + 1;
        if (members_ < options.threads) note_shortage(options.threads, members_);
    }
    ~Team() {
        level_ = {};
        open();
    }
    Team(const Team&) = delete;
    Team& operator=(const Team&) = delete;

    /// Runs the tasks of one level side by side; all have finished on return.
    void run_level(std::span<const int> tasks) noexcept {
        if (tasks.size() == 1 || members_ == 1) {
            run_.tasks(tasks, 0);
            return;
        }
        level_ = tasks;
        const std::uint64_t number = open();
        run_.tasks(share(tasks, 0, members_), 0);
        for (std::size_t worker = 1; worker < static_cast<std::size_t>(members_); ++worker) {
            static_cast<void>(backoff_.change(done_[worker].value, number - 1));
        }
    }

private:
    struct alignas(apart) Counter {
        std::atomic<std::uint64_t> value{0};
    };

    std::uint64_t open() noexcept {
        const std::uint64_t number = opened_.value.load(std::memory_order_relaxed) + 1;
        opened_.value.store(number, std::memory_order_release);
        return number;
    }

    void work(int worker) noexcept {
        Backoff backoff = untried_;
        const Pin pin(options_.pin, processors_, worker);
        for (std::uint64_t number = 0;;) {
            number = backoff.change(opened_.value, number);
            if (level_.empty()) return;
            run_.tasks(share(level_, worker, members_), worker);
            done_[static_cast<std::size_t>(worker)].value.store(number, std::memory_order_release);
        }
    }

    Run& run_;
    const ExecutorOptions& options_;
    const Backoff untried_;
    Backoff backoff_ = untried_;  ///< the calling thread's
    Processors processors_;
    Pin own_;
    int members_ = 1;             ///< read by workers after the first `opened`
    std::span<const int> level_;  ///< empty: leave
    std::unique_ptr<Counter[]> done_;
    Counter opened_;
    std::vector<std::jthread> threads_;  ///< last, so that they have left before the rest goes
};

void run_by_barriers(Run& run, const ExecutorOptions& options, int first) {
    Team team(run, options);
    for (int cycle = first; cycle != Controller::stop; cycle = run.decide(0)) {
        for (int level = 0; level < run.graph().levels(cycle); ++level) team.run_level(run.graph().level(cycle, level));
    }
}

constexpr Way barrier{"barrier", run_by_barriers};

}  // namespace

Runtime barrier_runtime() {
    return {"",
            {{.name = barrier.name,
              .description = "own threads that meet at a barrier after every level",
              .parallel = true,
              .waiting = Waiting::own,
              .make = make<barrier>}}};
}

}  // namespace cvtflow::bench
