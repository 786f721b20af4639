#pragma once
#include <stdexcept>

#include "engine/executor/tbb/edge_board.hpp"

namespace cvtflow::engine {

template <class Machine>
EdgeBoardOn<Machine>::EdgeBoardOn(Run& run, const ExecutorOptions& options, int first)
    : run_(run),
      options_(options),
      untried_(options),
      workers_(options.threads),
      taken_(std::make_unique<Padded[]>(static_cast<std::size_t>(workers_))) {
    const TaskGraph& graph = run.graph();
    if (static_cast<std::uint64_t>(graph.cycles()) >= Word::most) throw std::length_error("executor: too many cycles");
    std::vector<int> stamp_of(static_cast<std::size_t>(graph.size()), none);
    int stamps = 0;
    constexpr int line = static_cast<int>(Machine::numbers_together);
    std::vector<std::vector<int>> before(static_cast<std::size_t>(graph.size()));
    for (int cycle = 0; cycle < graph.cycles(); ++cycle) {
        for (int worker = 0; worker < workers_; ++worker) {
            for (int level = 0; level < graph.levels(cycle); ++level) {
                for (const int task : share(graph.level(cycle, level), worker, workers_)) {
                    if (graph.successors(task).empty()) continue;
                    stamp_of[static_cast<std::size_t>(task)] = stamps++;
                    for (const int after : graph.successors(task)) before[static_cast<std::size_t>(after)].push_back(stamps - 1);
                }
                stamps = (stamps + line - 1) / line * line;
            }
        }
    }
    for (int cycle = 0; cycle < graph.cycles(); ++cycle) {
        for (int worker = 0; worker < workers_; ++worker) {
            shares_.push_back({places_.size(), 0});
            for (int level = 0; level < graph.levels(cycle); ++level) {
                for (const int task : share(graph.level(cycle, level), worker, workers_)) {
                    const auto& waits = before[static_cast<std::size_t>(task)];
                    places_.push_back(
                        {task, stamp_of[static_cast<std::size_t>(task)], static_cast<int>(waits_.size()), static_cast<int>(waits.size())});
                    waits_.insert(waits_.end(), waits.begin(), waits.end());
                }
            }
            shares_.back().size = places_.size() - shares_.back().first;
            if (shares_.back().size >= Word::most) throw std::length_error("executor: too many tasks in a cycle");
        }
    }
    stamps_ = std::make_unique<Stamps[]>(static_cast<std::size_t>(stamps / line));
    open_cycle(1, first);
}

template <class Machine>
std::uint64_t EdgeBoardOn<Machine>::open_cycle(std::uint64_t sequence, int cycle) noexcept {
    const bool over = cycle == Controller::stop;
    if (!over) unfinished_.value.store(run_.graph().topological(cycle).size(), std::memory_order_relaxed);
    const std::uint64_t word = Word::make(sequence, over ? Word::most : static_cast<std::uint64_t>(cycle));
    open_.value.store(word, std::memory_order_release);
    return word;
}

template <class Machine>
bool EdgeBoardOn<Machine>::ready(const Place& place, std::uint64_t sequence) const noexcept {
    for (int wait = 0; wait < place.waits; ++wait) {
        const int number = waits_[static_cast<std::size_t>(place.first_wait + wait)];
        if (stamp(number).load(std::memory_order_acquire) != sequence) return false;
    }
    return true;
}

template <class Machine>
typename EdgeBoardOn<Machine>::Head EdgeBoardOn<Machine>::head(int owner, std::uint64_t open) const noexcept {
    const std::uint64_t sequence = Word::sequence(open),
                        seen = taken_[static_cast<std::size_t>(owner)].value.load(std::memory_order_relaxed);
    const Share& share = share_of(Word::count(open), owner);
    const std::uint64_t position = Word::sequence(seen) == sequence ? Word::count(seen) : 0;
    if (Word::sequence(seen) > sequence || position >= share.size) return Head::none;
    return ready(places_[share.first + position], sequence) ? Head::ready : Head::blocked;
}

/// Runs what nobody has taken of the owner's share of the open cycle and is ready. Returns whether something is left.
template <class Machine>
bool EdgeBoardOn<Machine>::run_ready(int worker, int owner, std::uint64_t open, std::uint64_t& ran) noexcept {
    const std::uint64_t sequence = Word::sequence(open);
    const Share& share = share_of(Word::count(open), owner);
    Atomic<std::uint64_t>& taken = taken_[static_cast<std::size_t>(owner)].value;
    std::uint64_t seen = taken.load(std::memory_order_relaxed);
    for (;;) {
        const std::uint64_t position = Word::sequence(seen) == sequence ? Word::count(seen) : 0;
        if (Word::sequence(seen) > sequence || position >= share.size) return false;
        const Place& place = places_[share.first + position];
        if (!ready(place, sequence)) return true;
        const std::uint64_t claimed = Word::make(sequence, position + 1);
        if (!taken.compare_exchange_weak(seen, claimed, std::memory_order_relaxed)) continue;
        run_.task(place.task, worker);
        if (place.stamp != none) stamp(place.stamp).store(sequence, std::memory_order_release);
        ++ran;
        seen = claimed;
    }
}

/// Whether there is something to do, or nothing left to wait for. Looks at others' shares only when patience is at an end.
template <class Machine>
bool EdgeBoardOn<Machine>::may_go_on(int worker, std::uint64_t open, int& patience) const noexcept {
    const Head own = head(worker, open);
    if (own == Head::ready) return true;
    if (own == Head::blocked && --patience > 0) return false;
    bool blocked = own == Head::blocked;
    for (int owner = 0; owner < workers_; ++owner) {
        if (owner == worker) continue;
        const Head theirs = head(owner, open);
        if (theirs == Head::ready) return true;
        blocked = blocked || theirs == Head::blocked;
    }
    return !blocked;
}

/// Takes part in the open cycle. Returns the open word to go on with: the next one if this worker was the last finisher and opened it,
/// else the same.
template <class Machine>
std::uint64_t EdgeBoardOn<Machine>::run_cycle(int worker, std::uint64_t open, typename Machine::Waiter& waiter) noexcept {
    std::uint64_t ran = 0;
    bool helped = false;
    for (;;) {
        const std::uint64_t before = ran;
        bool left = run_ready(worker, worker, open, ran);
        if (!left || helped) {
            helped = false;
            const std::uint64_t own = ran;
            for (int step = 1; step < workers_; ++step) {
                const int owner = worker + step < workers_ ? worker + step : worker + step - workers_;
                left = run_ready(worker, owner, open, ran) || left;
            }
            helped = ran > own;
            if (!left) break;
        }
        if (ran != before && helped) continue;
        int patience = Machine::patience;
        waiter.until([&]() noexcept { return may_go_on(worker, open, patience); });
        helped = patience <= 0;
    }
    if (ran == 0 || unfinished_.value.fetch_sub(ran, std::memory_order_acq_rel) != ran) return open;
    return open_cycle(Word::sequence(open) + 1, run_.decide(worker));
}

/// Is away while others work. Does nothing if nobody else is at work.
template <class Machine>
void EdgeBoardOn<Machine>::leave(typename Machine::Presence& presence) noexcept {
    int at_work = at_work_.value.load(std::memory_order_relaxed);
    do {
        if (at_work == 1) return;
    } while (!at_work_.value.compare_exchange_weak(at_work, at_work - 1, std::memory_order_relaxed));
    presence.away([&]() noexcept { return Word::count(open_.value.load(std::memory_order_relaxed)) == Word::most; });
    at_work_.value.fetch_add(1, std::memory_order_relaxed);
    presence.returned();
}

template <class Machine>
void EdgeBoardOn<Machine>::work(int worker) noexcept {
    typename Machine::Waiter waiter = untried_;
    typename Machine::Presence presence(options_);
    at_work_.value.fetch_add(1, std::memory_order_relaxed);
    std::uint64_t open = open_.value.load(std::memory_order_acquire);
    while (Word::count(open) != Word::most) {
        if (presence.due()) leave(presence);
        const std::uint64_t next = run_cycle(worker, open, waiter);
        open = next != open ? next : waiter.change(open_.value, open);
    }
    at_work_.value.fetch_sub(1, std::memory_order_relaxed);
}

}  // namespace cvtflow::engine
