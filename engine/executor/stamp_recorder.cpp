#include "engine/executor/stamp_recorder.hpp"

#include <algorithm>
#include <stdexcept>

namespace cvtflow::engine {

StampRecorder::StampRecorder(int threads, int capacity) {
    if (threads < 1 || capacity < 1) throw std::invalid_argument("stamp recorder: needs a thread and a place for a stamp");
    tracks_.resize(static_cast<std::size_t>(threads));
    for (Track& track : tracks_) track.ring.resize(static_cast<std::size_t>(capacity));
}

void StampRecorder::mark_all(SpanCode code) noexcept {
    const std::int64_t now = ticks();
    for (int thread = 0; thread < threads(); ++thread) add(thread, code, now, now);
}

void StampRecorder::begin_run() noexcept { mark_all(span_enter); }
void StampRecorder::end_run() noexcept { mark_all(span_exit); }

std::vector<Span> StampRecorder::spans(int thread) const {
    const Track& track = tracks_[static_cast<std::size_t>(thread)];
    const double rate = scale_.nanoseconds_per_tick();
    const auto time = [&](std::int64_t at) { return static_cast<std::int64_t>(rate * static_cast<double>(at - scale_.begin())); };
    std::vector<Span> result;
    const std::size_t kept = std::min(track.count, track.ring.size());
    for (std::size_t number = track.count - kept; number < track.count; ++number) {
        const Stamp& stamp = track.ring[number % track.ring.size()];
        Span span{stamp.what, time(stamp.begin), time(stamp.end)};
        if (!result.empty() && span.what != span_enter) {
            Span& before = result.back();
            if (before.what == span_enter) before.end = span.begin;
            if (span.what == span_exit) span.begin = before.end;
            if (before.end < span.begin) result.push_back({span_wait, before.end, span.begin});
        }
        result.push_back(span);
    }
    return result;
}

long StampRecorder::lost(int thread) const noexcept {
    const Track& track = tracks_[static_cast<std::size_t>(thread)];
    return track.count > track.ring.size() ? static_cast<long>(track.count - track.ring.size()) : 0;
}

void StampRecorder::clear() noexcept {
    for (Track& track : tracks_) track.count = 0;
}

}  // namespace cvtflow::engine
