#include "bench/executor/span_recorder.hpp"

#include <algorithm>

namespace cvtflow::bench {

std::vector<Span> SpanRecorder::spans(int thread) const {
    const Track& track = tracks_[static_cast<std::size_t>(thread)];
    const double rate = scale_.nanoseconds_per_tick();
    const auto time = [&](std::int64_t at) { return static_cast<std::int64_t>(rate * static_cast<double>(at - scale_.begin())); };
    std::vector<Span> result;
    const std::size_t kept = std::min(track.count, track.ring.size());
    for (std::size_t number = track.count - kept; number < track.count; ++number) {
        const Stamp& stamp = track.ring[number % track.ring.size()];
        Span span{stamp.what, time(stamp.begin), time(stamp.end)};
        if (!result.empty() && span.what != engine::span_enter) {
            Span& before = result.back();
            if (before.what == engine::span_enter) before.end = span.begin;
            if (span.what == engine::span_exit) span.begin = before.end;
            if (before.end < span.begin) result.push_back({engine::span_wait, before.end, span.begin});
        }
        result.push_back(span);
    }
    return result;
}

long SpanRecorder::lost(int thread) const noexcept {
    const Track& track = tracks_[static_cast<std::size_t>(thread)];
    return track.count > track.ring.size() ? static_cast<long>(track.count - track.ring.size()) : 0;
}

void SpanRecorder::clear() noexcept {
    for (Track& track : tracks_) track.count = 0;
}

}  // namespace cvtflow::bench
