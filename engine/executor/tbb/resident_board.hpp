#pragma once
/// The protocol of resident workers: a board on which levels of tasks are opened and their tasks claimed. Private to this folder;
/// knows nothing of who provides the threads.

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/executor/run.hpp"
#include "engine/executor/tbb/board_machine.hpp"

namespace cvtflow::engine {

/// Workers come and go as they like: one that never comes, or is away for a while, costs speed and nothing else. Any one of them
/// finishes everything. Allocates in the constructor only.
/// @tparam Machine what it stands on: BoardMachine, or in tests one that goes through every interleaving
template <class Machine>
class ResidentBoardOn {
public:
    /// `first` is the first cycle, already decided.
    /// @throws std::length_error for more than a million levels or tasks per level and worker
    ResidentBoardOn(Run& run, const ExecutorOptions& options, int first);

    /// Takes part until the controller says stop. Worker numbers are 0 … threads - 1, at most one thread works under each.
    void work(int worker) noexcept;

private:
    template <class Value>
    using Atomic = typename Machine::template Atomic<Value>;

    /// A sequence number that grows by one per opened level (44 bits: half a year of microseconds), and a count (20 bits).
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
    struct Level {
        std::span<const int> tasks;
        int next;  ///< number of the level that follows, or last
    };
    static constexpr int last = -1;

    [[nodiscard]] std::uint64_t finish(int worker, std::uint64_t open) noexcept;
    [[nodiscard]] std::uint64_t run_share(int worker, int owner, std::uint64_t open) noexcept;
    [[nodiscard]] bool settle(std::uint64_t ran) noexcept;
    [[nodiscard]] std::uint64_t open_next(int worker, std::uint64_t finished) noexcept;
    std::uint64_t open_level(std::uint64_t sequence, std::uint64_t level) noexcept;
    void leave(typename Machine::Presence& presence) noexcept;

    Run& run_;
    const ExecutorOptions options_;
    const typename Machine::Waiter untried_;
    int workers_;
    std::vector<Level> levels_;               ///< of all cycles
    std::vector<std::uint64_t> first_level_;  ///< [cycle]
    std::unique_ptr<Padded[]> taken_;         ///< [worker] sequence and number of tasks taken of the worker's share
    Padded open_;                             ///< sequence and number of the open level
    Padded unfinished_;                       ///< tasks of the open level
    Count at_work_;                           ///< workers that have come and are not away
};

using ResidentBoard = ResidentBoardOn<BoardMachine>;
extern template class ResidentBoardOn<BoardMachine>;

}  // namespace cvtflow::engine
