#pragma once
/// Reads the time stamps of an executor: tasks and the controller are stamped; waiting, arriving and leaving are the intervals in between.
///
///     run()   |enter|task 3|wait|controller|task 3|task 4|  wait  |task 3|exit|

#include "engine/executor/stamp_recorder.hpp"

namespace cvtflow::bench {

/// Converts ticks to nanoseconds: the rate is the progress of both clocks since construction, so that no calibration is needed.
class TickScale {
public:
    /// Rate up to now [ns per tick]. Good to 1e-4 once a millisecond has passed.
    [[nodiscard]] double nanoseconds_per_tick() const noexcept {
        const std::chrono::duration<double, std::nano> passed = std::chrono::steady_clock::now() - steady_;
        return passed.count() / static_cast<double>(engine::ticks() - ticks_);
    }
    [[nodiscard]] std::int64_t begin() const noexcept { return ticks_; }

private:
    std::chrono::steady_clock::time_point steady_ = std::chrono::steady_clock::now();
    std::int64_t ticks_ = engine::ticks();
};

struct Span {
    int what;            ///< task number or SpanCode
    std::int64_t begin;  ///< time since the recorder was constructed [ns]
    std::int64_t end;    ///< [ns]
};

class SpanRecorder : public engine::StampRecorder {
public:
    using StampRecorder::StampRecorder;

    /// All spans of a thread that are still kept, ascending, without gaps within a run. Not while an executor runs.
    [[nodiscard]] std::vector<Span> spans(int thread) const;
    /// Stamps of a thread that newer ones have overwritten.
    [[nodiscard]] long lost(int thread) const noexcept;
    /// Forgets everything.
    void clear() noexcept;

private:
    TickScale scale_;
};

}  // namespace cvtflow::bench
