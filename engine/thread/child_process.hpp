#pragma once
/// Work in a child process, for what may take its process down. The parent must have no threads.

#include <functional>
#include <span>
#include <vector>

namespace cvtflow::engine {

/// Numbers in memory that a parent and its children share, each slot written by one worker.
class SharedSlots {
public:
    static constexpr long none = -1;

    /// All none. @throws std::bad_alloc
    explicit SharedSlots(int count);
    ~SharedSlots();
    SharedSlots(const SharedSlots&) = delete;
    SharedSlots& operator=(const SharedSlots&) = delete;

    void set(int slot, long number) noexcept;
    void clear() noexcept;
    /// All that are not none, ascending.
    [[nodiscard]] std::vector<long> taken() const;

private:
    std::span<long> slots_;
};

/// Signals that ask work to end in good order: SIGINT, SIGTERM; SIGHUP (the terminal is gone), SIGXCPU (the limit of processor time, once a
/// second until it is final) and SIGPIPE (no reader left) unless this process was started with them ignored, as under nohup.
[[nodiscard]] std::vector<int> ending_signals();

/// End of a child.
struct ChildEnd {
    int status = 0;            ///< exit status, or 128 + signal
    int signal = 0;            ///< signal that ended it; 0: it ended by itself
    bool interrupted = false;  ///< an ending signal came while it lived
};

/// Runs `work` in a child and waits for it. Ending signals of other processes are handed on to it (a terminal's Ctrl-C reaches both
/// anyway); it dies with its parent. One at a time.
/// @param work must not throw; its result is the exit status   @throws std::system_error if there can be no more processes
[[nodiscard]] ChildEnd run_child(const std::function<int()>& work);

}  // namespace cvtflow::engine
