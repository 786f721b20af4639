#pragma once
/// The protocol of resident workers: a board on which cycles are opened, and their tasks claimed as soon as their predecessors have
/// finished. Private to this folder; independent of the source of the threads.
///
/// Why this is free of races, and why every task runs exactly once. Cycle s with tasks a ─► b, b's share being worker B's:
///
///     opener   unfinished = n; open ◄─ (s, cycle)
///                                 │ release/acquire
///     worker A                    ├──► taken[A]: (<s, ·) ─► (s, 1) ─► a ─► stamp[a] ◄─ s ─── all taken ──► unfinished -= 1
///                                 │                                       │ release/acquire                │ acq_rel, a chain
///     worker B                    └──► stamp[a] = s? ·················· yes ─► taken[B]: (s, 1) ─► b ──► unfinished -= 1  = 0: B is
///                                                                                            the last, decides, opens (s + 1, cycle')
///
/// Once only. The tasks of a cycle are cut into one share per worker: of every level its part, level by level. The right to run the k-th
/// task of a share in sequence s is the compare-and-swap that makes taken[share] = (s, k + 1). Its modifications are totally ordered and
/// never decrease, so it succeeds once for each (s, k). Sequence s is over only when all n tasks are claimed and finished, hence every
/// share that has tasks is at (s, full) or later: a worker that slept since it read (s, cycle) finds nothing left to claim, however stale
/// its first value of `taken` was, because a compare-and-swap never succeeds on a stale value. It then reads `open` again.
///
/// After its predecessors. A task is claimed by a worker that has seen s in the stamps of all its predecessors. A stamp is stored after its
/// task by the worker that ran it, as a release, and seen as an acquire, so everything that the predecessors read or wrote happens before
/// the task; so does everything that their predecessors did, because the workers that ran them had seen their stamps. Sequences are never
/// reused, so nothing is reset: a stamp below s is of an earlier cycle, one above s means that s is over, and then the claim fails.
///
/// Seen by all. A worker enters sequence s by an acquire of `open` that reads the opener's release, so relaxed order suffices for
/// claims: they determine the worker, not visibility. Each worker subtracts its finished tasks from `unfinished` by acquire-release; these
/// read-modify-writes form one release sequence, so the worker that reaches 0 comes after everything that was read or written in s, runs
/// the controller alone, and publishes all of it by the release of `open`. It also may write `unfinished` plainly: every subtraction of s
/// has happened, and none of s + 1 can before `open` is stored.
///
/// Progress. A worker never waits for another worker, only for a task that is claimed and running, or for the last finisher: of all
/// unclaimed tasks, one of the lowest level is the first of its share, and its predecessors are claimed; a waiting worker checks all shares
/// until all tasks are claimed. A worker that loses its processor to others leaves for a while (ContentionBackoff), the last one at work
/// never: at_work_ falls from n to n - 1 by a compare-and-swap only if n > 1.
///
/// Cache lines. A line that two workers exchange costs 0.1 … 0.3 µs. Within a cycle these are the stamp of a task and its data. The claim
/// is therefore on another line, which no other worker touches as long as all keep pace, and the stamps of a worker and level are on
/// separate lines. A worker that waits for its next task checks the claims of others after a while, and continues to do so at once as
/// long as it finds tasks there, as it does while a worker is away.
///
/// tests/engine/executor/tbb/resident_board_test.cpp runs all interleavings of small cases, and finds that each of these orders is needed.

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "engine/executor/run.hpp"
#include "engine/thread/backoff.hpp"

namespace cvtflow::engine {

/// The machine of a board of resident workers: atomics, waiting, and leaving the processor.
struct BoardMachine {
    template <class Value>
    using Atomic = std::atomic<Value>;
    using Waiter = Backoff;
    static constexpr std::size_t numbers_together = apart / sizeof(std::uint64_t);  // on one line
    static constexpr int max_polls = 50;  // polls of a worker's share before it checks others, about 1 us

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
        const bool retreats_;  // not with Wait::spin
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

    /// Takes part until the controller returns stop. Worker numbers are 0 … threads - 1, at most one thread works under each.
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
    /// Stamps of tasks of one worker and level.
    struct alignas(apart) Stamps {
        std::array<Atomic<std::uint64_t>, Machine::numbers_together> values{};
    };
    /// A task in its share.
    struct Place {
        int task;
        int stamp;                      ///< stamp of the task, or none if no task depends on it
        std::size_t first_wait, waits;  ///< stamps of its predecessors, in waits_
    };
    struct Share {
        std::size_t first, size;  ///< range in places_
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
    [[nodiscard]] bool may_resume(int worker, std::uint64_t open, int& polls_left) const noexcept;
    [[nodiscard]] std::uint64_t run_all(int worker, std::uint64_t open, typename Machine::Waiter& waiter) noexcept;
    [[nodiscard]] std::uint64_t finish(int worker, std::uint64_t open, typename Machine::Waiter& waiter) noexcept;
    std::uint64_t open_cycle(std::uint64_t sequence, int cycle) noexcept;
    void leave(typename Machine::Presence& presence) noexcept;

    Run& run_;
    const ExecutorOptions options_;
    const typename Machine::Waiter untried_;
    int workers_;
    std::vector<Place> places_;         ///< all tasks, by shares, in an order that respects all edges
    std::vector<int> waits_;            ///< stamps
    std::vector<Share> shares_;         ///< [cycle][worker]
    std::unique_ptr<Stamps[]> stamps_;  ///< sequence in which a task has finished last
    std::unique_ptr<Padded[]> taken_;   ///< [worker] sequence and number of tasks taken of the worker's share
    Padded open_;                       ///< sequence and number of the open cycle
    Padded unfinished_;                 ///< tasks of the open cycle
    Count at_work_;                     ///< workers that have come and are not away
};

using ResidentBoard = ResidentBoardOn<BoardMachine>;

template <class Machine>
ResidentBoardOn<Machine>::ResidentBoardOn(Run& run, const ExecutorOptions& options, int first)
    : run_(run),
      options_(options),
      untried_(options),
      workers_(options.threads),
      taken_(std::make_unique<Padded[]>(static_cast<std::size_t>(workers_))) {
    if (static_cast<std::uint64_t>(run.graph().cycles()) >= Word::most) throw std::length_error("executor: too many cycles");
    std::vector<int> stamp_of(static_cast<std::size_t>(run.graph().size()), none);
    add_stamps(stamp_of);
    add_shares(stamp_of);
    open_cycle(1, first);
}

/// Numbers the stamps of tasks that others wait for. stamp_of [tasks]
template <class Machine>
void ResidentBoardOn<Machine>::add_stamps(std::vector<int>& stamp_of) {
    const TaskGraph& graph = run_.graph();
    constexpr int together = static_cast<int>(Machine::numbers_together);
    int lines = 0;
    for (int cycle = 0; cycle < graph.cycles(); ++cycle) {
        for (int level = 0; level + 1 < graph.levels(cycle); ++level) {
            for (int worker = 0; worker < workers_; ++worker) {
                int stamp = lines * together;
                for (const int task : share(graph.level(cycle, level), worker, workers_)) {
                    if (!graph.successors(task).empty()) stamp_of[static_cast<std::size_t>(task)] = stamp++;
                }
                lines = (stamp + together - 1) / together;
            }
        }
    }
    stamps_ = std::make_unique<Stamps[]>(static_cast<std::size_t>(lines));
}

/// Lists the tasks of every worker with what they wait for.
template <class Machine>
void ResidentBoardOn<Machine>::add_shares(const std::vector<int>& stamp_of) {
    const TaskGraph& graph = run_.graph();
    std::vector<std::vector<int>> waits_of(stamp_of.size());
    for (int task = 0; task < graph.size(); ++task) {
        for (const int after : graph.successors(task))
            waits_of[static_cast<std::size_t>(after)].push_back(stamp_of[static_cast<std::size_t>(task)]);
    }
    for (int cycle = 0; cycle < graph.cycles(); ++cycle) {
        for (int worker = 0; worker < workers_; ++worker) {
            const std::size_t first = places_.size();
            for (int level = 0; level < graph.levels(cycle); ++level) {
                for (const int task : share(graph.level(cycle, level), worker, workers_)) {
                    const std::vector<int>& waits = waits_of[static_cast<std::size_t>(task)];
                    places_.push_back({task, stamp_of[static_cast<std::size_t>(task)], waits_.size(), waits.size()});
                    waits_.insert(waits_.end(), waits.begin(), waits.end());
                }
            }
            shares_.push_back({first, places_.size() - first});
            if (shares_.back().size >= Word::most) throw std::length_error("executor: too many tasks in a cycle");
        }
    }
}

template <class Machine>
std::uint64_t ResidentBoardOn<Machine>::open_cycle(std::uint64_t sequence, int cycle) noexcept {
    const bool over = cycle == Controller::stop;
    if (!over) unfinished_.value.store(run_.graph().topological(cycle).size(), std::memory_order_relaxed);
    const std::uint64_t word = Word::make(sequence, over ? Word::most : static_cast<std::uint64_t>(cycle));
    open_.value.store(word, std::memory_order_release);
    return word;
}

template <class Machine>
bool ResidentBoardOn<Machine>::ready(const Place& place, std::uint64_t sequence) const noexcept {
    for (std::size_t wait = place.first_wait; wait < place.first_wait + place.waits; ++wait) {
        if (stamp(waits_[wait]).load(std::memory_order_acquire) != sequence) return false;
    }
    return true;
}

/// @param taken last value read of the owner's share
template <class Machine>
typename ResidentBoardOn<Machine>::Head ResidentBoardOn<Machine>::head(int owner, std::uint64_t open, std::uint64_t taken) const noexcept {
    const std::uint64_t sequence = Word::sequence(open);
    const Share& share = share_of(open, owner);
    const std::uint64_t position = Word::sequence(taken) == sequence ? Word::count(taken) : 0;
    if (Word::sequence(taken) > sequence || position >= share.size) return Head::none;
    return ready(places_[share.first + position], sequence) ? Head::ready : Head::blocked;
}

/// Runs the unclaimed ready tasks of the owner's share of the open cycle. Returns whether some of the share is left.
template <class Machine>
bool ResidentBoardOn<Machine>::run_share(int worker, int owner, std::uint64_t open, std::uint64_t& ran) noexcept {
    const std::uint64_t sequence = Word::sequence(open);
    Atomic<std::uint64_t>& taken = taken_[static_cast<std::size_t>(owner)].value;
    std::uint64_t seen = taken.load(std::memory_order_relaxed);
    for (;;) {
        if (const Head first = head(owner, open, seen); first != Head::ready) return first == Head::blocked;
        const std::uint64_t position = Word::sequence(seen) == sequence ? Word::count(seen) : 0;
        const std::uint64_t claimed = Word::make(sequence, position + 1);
        if (!taken.compare_exchange_weak(seen, claimed, std::memory_order_relaxed)) continue;
        const Place& place = places_[share_of(open, owner).first + position];
        run_.task(place.task, worker);
        if (place.stamp != none) stamp(place.stamp).store(sequence, std::memory_order_release);
        ++ran;
        seen = claimed;
    }
}

/// Whether a task of the open cycle is ready, or all are taken. Checks others' shares after `polls_left` polls of the worker's.
template <class Machine>
bool ResidentBoardOn<Machine>::may_resume(int worker, std::uint64_t open, int& polls_left) const noexcept {
    const auto head_of = [&](int owner) noexcept {
        return head(owner, open, taken_[static_cast<std::size_t>(owner)].value.load(std::memory_order_relaxed));
    };
    const Head first_head = head_of(worker);
    if (first_head == Head::ready) return true;
    bool blocked = first_head == Head::blocked;
    if (blocked && polls_left > 0) {
        --polls_left;
        return false;
    }
    for (int owner = 0; owner < workers_; ++owner) {
        const Head theirs = owner == worker ? first_head : head_of(owner);
        if (theirs == Head::ready) return true;
        blocked = blocked || theirs == Head::blocked;
    }
    return !blocked;
}

/// Takes part in the open cycle until all its tasks are taken. Returns how many it ran.
template <class Machine>
std::uint64_t ResidentBoardOn<Machine>::run_all(int worker, std::uint64_t open, typename Machine::Waiter& waiter) noexcept {
    std::uint64_t ran = 0;
    for (bool helps = false;;) {
        bool left = run_share(worker, worker, open, ran);
        if (!left || helps) {
            const std::uint64_t ran_before = ran;
            for (int step = 1; step < workers_; ++step) {
                const int owner = worker + step < workers_ ? worker + step : worker + step - workers_;
                left = run_share(worker, owner, open, ran) || left;
            }
            if (!left) return ran;
            if (ran > ran_before) continue;
        }
        int polls_left = Machine::max_polls;
        waiter.until([&]() noexcept { return may_resume(worker, open, polls_left); });
        helps = polls_left == 0;
    }
}

/// Takes part in the open cycle. Returns the open word to continue with: the next one if this worker was the last finisher and opened it,
/// else the same.
template <class Machine>
std::uint64_t ResidentBoardOn<Machine>::finish(int worker, std::uint64_t open, typename Machine::Waiter& waiter) noexcept {
    const std::uint64_t ran = run_all(worker, open, waiter);
    if (ran == 0 || unfinished_.value.fetch_sub(ran, std::memory_order_acq_rel) != ran) return open;
    return open_cycle(Word::sequence(open) + 1, run_.decide(worker));
}

/// Leaves the processor while others work. No effect without other workers.
template <class Machine>
void ResidentBoardOn<Machine>::leave(typename Machine::Presence& presence) noexcept {
    int at_work = at_work_.value.load(std::memory_order_relaxed);
    do {
        if (at_work == 1) return;
    } while (!at_work_.value.compare_exchange_weak(at_work, at_work - 1, std::memory_order_relaxed));
    presence.away([&]() noexcept { return Word::count(open_.value.load(std::memory_order_relaxed)) == Word::most; });
    at_work_.value.fetch_add(1, std::memory_order_relaxed);
    presence.returned();
}

template <class Machine>
void ResidentBoardOn<Machine>::work(int worker) noexcept {
    typename Machine::Waiter waiter = untried_;
    typename Machine::Presence presence(options_);
    at_work_.value.fetch_add(1, std::memory_order_relaxed);
    std::uint64_t open = open_.value.load(std::memory_order_acquire);
    while (Word::count(open) != Word::most) {
        if (presence.due()) leave(presence);
        const std::uint64_t next = finish(worker, open, waiter);
        open = next != open ? next : waiter.change(open_.value, open);
    }
    at_work_.value.fetch_sub(1, std::memory_order_relaxed);
}

}  // namespace cvtflow::engine
