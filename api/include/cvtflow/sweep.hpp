#pragma once
/// Many variants of a scene, as `cvtflow batch` runs them.

#include <functional>
#include <memory>
#include <string>

#include <cvtflow/export.hpp>

namespace cvtflow {
inline namespace v0 {

struct SweepProgress {
    long cases = 0;     ///< number of all cases
    long before = 0;    ///< cases done in earlier sessions
    long done = 0;      ///< cases done now
    long failed = 0;    ///< cases done now with another status than ok
    double wall = 0.0;  ///< [s]
};

/// A sweep file, read and checked. Immutable but for cancel().
class CVTFLOW_EXPORT Sweep {
public:
    /// @throws Error (scene): every problem in it, one per line
    [[nodiscard]] static Sweep read(const std::string& path);
    ~Sweep();
    Sweep(Sweep&& other) noexcept;
    Sweep& operator=(Sweep&& other) noexcept;

    [[nodiscard]] const std::string& name() const noexcept;
    [[nodiscard]] long cases() const noexcept;
    /// Runs the cases that have no row in the folder yet, and waits for them. A sweep that was stopped or killed continues. Results do
    /// not depend on threads or interruptions. A sweep with [accuracy] is tuned first and verified in the end; its rows have the errors in
    /// columns `error_of_...`.
    /// @param threads 0: as many as the process may use
    /// @param progress called after each case, by one worker at a time
    /// @return whether all cases are in `folder`/results.csv; false after cancel()
    /// @throws Error (record) for folders and rows; (state) for results of another sweep, program version or start state, or if the first
    /// dozen cases all fail with the same message; (argument)
    bool run(const std::string& folder, int threads = 0, std::function<void(const SweepProgress&)> progress = {});
    /// Requests the end of run(), from any thread or signal handler; cases that it interrupts run again later. One request ends one run.
    void cancel() noexcept;

private:
    struct Impl;
    explicit Sweep(std::unique_ptr<Impl> impl) noexcept;
    std::unique_ptr<Impl> impl_;
};

}  // namespace v0
}  // namespace cvtflow
