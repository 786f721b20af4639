#pragma once
/// Why this is free of races, and why every task runs exactly once.
///
///     opener   unfinished = n; open ◄─ (s, level)
///                                 │ release/acquire
///     worker A                    ├──► taken[A]: (<s, ·) ─► (s, 1) ─► task ─► (s, 2) ─► task ─► full ─► unfinished -= 2
///     worker B                    └──► taken[B]: (<s, ·) ─► (s, 1) ─► task ····· late            │ acq_rel, a chain
///     worker A          takes from B:            (s, 1) ─► (s, 2) ─► task ────────────────► unfinished -= 1
///     worker B                                              late ····· done ──────────────► unfinished -= 1  = 0: B is the last,
///                                                                                            decides, opens (s + 1, level')
///
/// Once only. The tasks of a level are cut into one share per worker. The right to run the k-th task of a share in sequence s is the
/// compare-and-swap that makes taken[share] = (s, k + 1). Its modifications are totally ordered and never decrease, so it succeeds
/// once for each (s, k). Sequence s is over only when all n tasks are claimed and finished, hence every share that has tasks stands at
/// (s, full) or later: a worker that slept since it read (s, level) finds nothing left to claim, however stale its first look at
/// `taken` was, because a compare-and-swap never succeeds on a stale value. It then reads `open` anew.
///
/// Seen by all. A worker enters sequence s by an acquire of `open` that reads the opener's release, so relaxed order suffices for
/// claims: they settle who, not what is visible. Each worker subtracts its finished tasks from `unfinished` by acquire-release; these
/// read-modify-writes form one release sequence, so whoever reaches 0 has everything that was read or written in s behind it, runs the
/// controller alone, and hands all of it on by the release of `open`. It also may write `unfinished` plainly: every subtraction of
/// s has happened, and none of s + 1 can before `open` is stored.
///
/// Progress. Nobody waits for a worker, only for a task that somebody has claimed and is running, or for the last finisher. A worker
/// that loses its processor to others leaves for a while (contention_backoff.hpp), the last one at work never: at_work_ falls from n to n -
/// 1 by a compare-and-swap only if n > 1.
///
/// Shares and not single tasks carry the claims: a worker that looks for work reads one line per colleague rather than one per task,
/// and a colleague's next claim has one line to win back instead of many (0.1 µs each).

#include <stdexcept>

#include "engine/executor/tbb/resident_board.hpp"

namespace cvtflow::engine {

template <class Machine>
ResidentBoardOn<Machine>::ResidentBoardOn(Run& run, const ExecutorOptions& options, int first)
    : run_(run),
      options_(options),
      untried_(options),
      workers_(options.threads),
      taken_(std::make_unique<Padded[]>(static_cast<std::size_t>(workers_))) {
    const TaskGraph& graph = run.graph();
    for (int cycle = 0; cycle < graph.cycles(); ++cycle) {
        first_level_.push_back(levels_.size());
        for (int level = 0; level < graph.levels(cycle); ++level) {
            const int next = static_cast<int>(levels_.size()) + 1;
            levels_.push_back({graph.level(cycle, level), level + 1 < graph.levels(cycle) ? next : last});
            if (share(levels_.back().tasks, 0, workers_).size() >= Word::most)
                throw std::length_error("executor: too many tasks in a level");
        }
    }
    if (levels_.size() >= Word::most) throw std::length_error("executor: too many levels");
    open_level(1, first_level_[static_cast<std::size_t>(first)]);
}

template <class Machine>
std::uint64_t ResidentBoardOn<Machine>::open_level(std::uint64_t sequence, std::uint64_t level) noexcept {
    if (level != Word::most) unfinished_.value.store(levels_[level].tasks.size(), std::memory_order_relaxed);
    const std::uint64_t word = Word::make(sequence, level);
    open_.value.store(word, std::memory_order_release);
    return word;
}

template <class Machine>
std::uint64_t ResidentBoardOn<Machine>::open_next(int worker, std::uint64_t finished) noexcept {
    const std::uint64_t sequence = Word::sequence(finished) + 1;
    if (const int next = levels_[Word::count(finished)].next; next != last) return open_level(sequence, static_cast<std::uint64_t>(next));
    const int cycle = run_.decide(worker);
    return open_level(sequence, cycle == Controller::stop ? Word::most : first_level_[static_cast<std::size_t>(cycle)]);
}

/// Runs what nobody has taken of the owner's share of the open level. Returns how many tasks that were.
template <class Machine>
std::uint64_t ResidentBoardOn<Machine>::run_share(int worker, int owner, std::uint64_t open) noexcept {
    const std::uint64_t sequence = Word::sequence(open);
    const std::span<const int> tasks = share(levels_[Word::count(open)].tasks, owner, workers_);
    Atomic<std::uint64_t>& taken = taken_[static_cast<std::size_t>(owner)].value;
    std::uint64_t ran = 0;
    std::uint64_t seen = taken.load(std::memory_order_relaxed);
    for (;;) {
        const std::uint64_t position = Word::sequence(seen) == sequence ? Word::count(seen) : 0;
        if (Word::sequence(seen) > sequence || position >= tasks.size()) return ran;
        const std::uint64_t claimed = Word::make(sequence, position + 1);
        if (!taken.compare_exchange_weak(seen, claimed, std::memory_order_relaxed)) continue;
        run_.task(tasks[position], worker);
        ++ran;
        seen = claimed;
    }
}

/// Takes tasks that ran off the unfinished ones. Returns whether they were the last: the caller is alone then.
template <class Machine>
bool ResidentBoardOn<Machine>::settle(std::uint64_t ran) noexcept {
    return ran > 0 && unfinished_.value.fetch_sub(ran, std::memory_order_acq_rel) == ran;
}

/// Runs what is left of the open level, own share first. Returns the open word to go on with: the next one if this worker was the last
/// finisher and opened it, else the same.
template <class Machine>
std::uint64_t ResidentBoardOn<Machine>::finish(int worker, std::uint64_t open) noexcept {
    for (int step = 0; step < workers_; ++step) {
        const int owner = worker + step < workers_ ? worker + step : worker + step - workers_;
        if (settle(run_share(worker, owner, open))) return open_next(worker, open);
    }
    return open;
}

/// Is away while others work. Does nothing if nobody else is at work.
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
        const std::uint64_t next = finish(worker, open);
        open = next != open ? next : waiter.change(open_.value, open);
    }
    at_work_.value.fetch_sub(1, std::memory_order_relaxed);
}

}  // namespace cvtflow::engine
