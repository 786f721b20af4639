#pragma once
/// The protocol of resident workers: a board on which cycles are opened, and their tasks claimed as soon as their predecessors have
/// finished. Private to this folder; independent of the source of the threads.

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include "engine/executor/run.hpp"
#include "engine/executor/tbb/contention_backoff.hpp"
#include "engine/thread/backoff.hpp"

namespace cvtflow::engine {

/// The machine of a board of resident workers: atomics, waiting, and leaving the processor.
struct BoardMachine {
    template <class Value>
    using Atomic = std::atomic<Value>;
    using Waiter = Backoff;
    static constexpr std::size_t numbers_together = apart / sizeof(std::uint64_t);  // on a line of their own
    static constexpr int patience = 50;  // polls of a worker's own tasks before it checks those of others, about 1 us

    /// Whether a worker is at work, or leaves its processor to others for a while.
    class Presence {
    public:
        explicit Presence(const ExecutorOptions& options) noexcept
            : contention_(ProcessorUse::now()), retreats_(options.wait != Wait::spin) {}

        /// Called between levels. Whether the worker should leave now.
        [[nodiscard]] bool due() noexcept { return retreats_ && round_++ % rounds_per_reading == 0 && contention_.due(); }
        /// Sleeps for the given time, or until over() is true.
        template <class Over>
        void away(const Over& over) noexcept {
            const auto until = std::chrono::steady_clock::now() + contention_.length();
            while (std::chrono::steady_clock::now() < until && !over()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        /// The worker is back at work.
        void returned() noexcept { contention_.returned(ProcessorUse::now()); }

    private:
        static constexpr int rounds_per_reading = 16;  // reading the clock costs 25 ns, a level takes at least 300

        ContentionBackoff contention_;
        const bool retreats_;  // not on a machine of one's own
        unsigned round_ = 0;
    };
};

/// Workers come and go as they like: one that never comes, or is away for a while, costs speed and nothing else. Any one of them
/// finishes everything. Allocates in the constructor only.
/// @tparam Machine atomics and waiting: BoardMachine, or in tests one that explores every interleaving
template <class Machine>
class ResidentBoardOn {
public:
    /// `first` is the first cycle, already decided.
    /// @throws std::length_error for more than a million cycles or tasks per cycle and worker
    ResidentBoardOn(Run& run, const ExecutorOptions& options, int first);

    /// Takes part until the controller says stop. Worker numbers are 0 … threads - 1, at most one thread works under each.
    void work(int worker) noexcept;

private:
    template <class Value>
    using Atomic = typename Machine::template Atomic<Value>;

    /// A sequence number that grows by one per opened cycle (44 bits: half a year of microseconds), and a count (20 bits).
    struct Word {
        static constexpr int count_bits = 20;
        static constexpr std::uint64_t most = (std::uint64_t{1} << count_bits) - 1;
        static std::uint64_t make(std::uint64_t sequence, std::uint64_t count) noexcept { return sequence << count_bits | count; }
        static std::uint64_t sequence(std::uint64_t word) noexcept { return word >> count_bits; }
        static std::uint64_t count(std::uint64_t word) noexcept { return word & most; }
    };
    struct alignas(apart) Padded {
        Atomic<std::uint64_t> value{0};
    };
    struct alignas(apart) Count {
        Atomic<int> value{0};
    };
    /// Of tasks of one worker and level.
    struct alignas(apart) Stamps {
        std::array<Atomic<std::uint64_t>, Machine::numbers_together> values{};
    };
    /// A task in its share.
    struct Place {
        int task;
        int stamp;                      ///< its stamp, or none if no task depends on it
        std::size_t first_wait, waits;  ///< stamps of its predecessors, in waits_
    };
    struct Share {
        std::size_t first, size;  ///< in places_
    };
    /// The first unclaimed task of a share.
    enum class Head { none, blocked, ready };
    static constexpr int none = -1;

    void add_stamps(std::vector<int>& stamp_of);
    void add_shares(const std::vector<int>& stamp_of);
    [[nodiscard]] const Share& share_of(std::uint64_t open, int owner) const noexcept {
        return shares_[Word::count(open) * static_cast<std::size_t>(workers_) + static_cast<std::size_t>(owner)];
    }
    [[nodiscard]] Atomic<std::uint64_t>& stamp(int number) const noexcept {
        const auto n = static_cast<std::size_t>(number);
        return stamps_[n / Machine::numbers_together].values[n % Machine::numbers_together];
    }
    [[nodiscard]] bool ready(const Place& place, std::uint64_t sequence) const noexcept;
    [[nodiscard]] Head head(int owner, std::uint64_t open, std::uint64_t taken) const noexcept;
    [[nodiscard]] bool run_share(int worker, int owner, std::uint64_t open, std::uint64_t& ran) noexcept;
    [[nodiscard]] bool may_go_on(int worker, std::uint64_t open, int& patience) const noexcept;
    [[nodiscard]] std::uint64_t run_all(int worker, std::uint64_t open, typename Machine::Waiter& waiter) noexcept;
    [[nodiscard]] std::uint64_t finish(int worker, std::uint64_t open, typename Machine::Waiter& waiter) noexcept;
    std::uint64_t open_cycle(std::uint64_t sequence, int cycle) noexcept;
    void leave(typename Machine::Presence& presence) noexcept;

    Run& run_;
    const ExecutorOptions options_;
    const typename Machine::Waiter untried_;
    int workers_;
    std::vector<Place> places_;         ///< of all tasks, by shares, in an order that respects all edges
    std::vector<int> waits_;            ///< stamps
    std::vector<Share> shares_;         ///< [cycle][worker]
    std::unique_ptr<Stamps[]> stamps_;  ///< sequence in which a task has finished last
    std::unique_ptr<Padded[]> taken_;   ///< [worker] sequence and number of tasks taken of the worker's share
    Padded open_;                       ///< sequence and number of the open cycle
    Padded unfinished_;                 ///< tasks of the open cycle
    Count at_work_;                     ///< workers that have come and are not away
};

using ResidentBoard = ResidentBoardOn<BoardMachine>;
extern template class ResidentBoardOn<BoardMachine>;

}  // namespace cvtflow::engine
