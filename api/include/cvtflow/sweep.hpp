#pragma once
/// Many variants of a scene, as `cvtflow batch` runs them.

#include <cvtflow/error.hpp>

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace cvtflow {
inline namespace v0_4 {

using SweepProgress = cvtflow_progress;

/// A sweep file, read and checked. Immutable but for cancel().
class Sweep {
public:
    /// @throws Error (scene): every problem in it, one per line
    [[nodiscard]] static Sweep read(const std::string& path) {
        Sweep sweep(path);
        const cvtflow_progress_function count = [](const SweepProgress* now, void* cases) {
            *static_cast<long*>(cases) = static_cast<long>(now->cases);
            return 0;
        };
        detail::call(cvtflow_sweep_run, path.c_str(), static_cast<const char*>(nullptr), 1, 0, count, static_cast<void*>(&sweep.cases_));
        return sweep;
    }
    [[nodiscard]] long cases() const noexcept { return cases_; }
    /// Runs the cases that have no row in the folder yet, and waits for them. A sweep that was stopped or killed continues. Results do
    /// not depend on threads or interruptions.
    /// @param threads 0: as many as the process may use
    /// @param progress called before the first case and after each, from one thread at a time; must not throw
    /// @param keep_going runs all cases, also where the first dozen fail with the same message
    /// @return whether all cases are in `folder`/results.csv; false after cancel()
    /// @throws Error (record) for folders and rows; (state) for results of another sweep, program version or start state, or if the first
    /// dozen cases all fail so; (argument)
    bool run(const std::string& folder, int threads = 0, std::function<void(const SweepProgress&)> progress = {}, bool keep_going = false) {
        struct Call {
            std::atomic<bool>& cancelled;
            const std::function<void(const SweepProgress&)>& progress;
            std::int64_t done;
        } call{*cancelled_, progress, -1};
        const cvtflow_progress_function report = [](const SweepProgress* now, void* user) {
            auto& of = *static_cast<Call*>(user);
            if (of.progress && now->done != of.done) of.progress(*now);
            of.done = now->done;
            return of.cancelled.load() ? 1 : 0;
        };
        detail::Message message;
        const cvtflow_code code =
            cvtflow_sweep_run(path_.c_str(), folder.c_str(), threads, keep_going ? 1 : 0, report, static_cast<void*>(&call), message.get());
        const bool ended = cancelled_->exchange(false);
        if (code == CVTFLOW_CANCELLED && ended) return false;
        message.check(code);
        return true;
    }
    /// Requests the end of run(), from any thread or signal handler; cases that it interrupts run again later. One request ends one run.
    void cancel() noexcept { cancelled_->store(true); }

private:
    explicit Sweep(std::string path) : path_(std::move(path)), cancelled_(std::make_unique<std::atomic<bool>>(false)) {}

    std::string path_;
    long cases_ = 0;
    std::unique_ptr<std::atomic<bool>> cancelled_;
};

}  // namespace v0_4
}  // namespace cvtflow
