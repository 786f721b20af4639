#pragma once
/// For measurements among others: threads that keep processors busy.

#include <memory>

namespace cvtflow::bench {

/// Reports that a measurement requires more threads than there are. @throws std::runtime_error
[[noreturn]] void too_few_threads(int requested);

/// Keeps `count` threads spinning, to emulate other load on a shared machine. They are not oneTBB's, so that no scheduler knows of them.
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
