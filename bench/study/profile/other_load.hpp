#pragma once
/// Other load on a machine: the share of the machine that is available now, which every measurement of threads needs, and threads that keep
/// processors busy, for measurements beside other load.

#include <memory>

namespace cvtflow::bench {

/// Number of processors that threads get, from their work for `seconds`: each counts short pieces of arithmetic, and the number of pieces
/// times the time of the quickest is the time for which its thread had a processor at full speed. `threads` on a quiet machine; less with
/// other load, on a host that takes time away, or with fewer processors. [1]
/// @throws std::runtime_error if the system has no threads for it
[[nodiscard]] double processors_got(int threads, double seconds);

/// Fraction of the requested processors below which a machine counts as crowded: speed-ups cannot be measured on it.
inline constexpr double crowded_below = 0.9;

/// Reports that a measurement requires more threads than there are. @throws std::runtime_error
[[noreturn]] void too_few_threads(int requested);

/// Keeps `count` threads spinning, to emulate other load on a shared machine. They are not oneTBB's: no scheduler takes them into account.
class BusyNeighbours {
public:
    /// Zero or less: none.
    explicit BusyNeighbours(int count);
    ~BusyNeighbours();
    BusyNeighbours(const BusyNeighbours&) = delete;
    BusyNeighbours& operator=(const BusyNeighbours&) = delete;

    /// Processor time that they have burned so far, all together [s].
    [[nodiscard]] double processor_seconds() const noexcept;

private:
    struct Threads;
    std::unique_ptr<Threads> threads_;
};

}  // namespace cvtflow::bench
