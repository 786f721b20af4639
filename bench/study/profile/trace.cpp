#include "bench/study/profile/trace.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cvtflow::bench {

namespace {

std::string span_name(const Recording& recording, int what) {
    if (what >= 0) return recording.tasks[static_cast<std::size_t>(what)];
    switch (what) {
        case engine::span_controller: return "controller";
        case engine::span_enter: return "enter";
        case engine::span_exit: return "exit";
        default: return "wait";
    }
}

}  // namespace

std::string profile_trace(const Profile& profile) {
    std::string text = "{\"displayTimeUnit\": \"ns\", \"traceEvents\": [";
    std::string separator = "\n";
    int process = 0;
    for (const ScheduleResult& result : profile.results) {
        text += fmt::format(
            "{}{{\"name\": \"process_name\", \"ph\": \"M\", \"pid\": {}, \"args\": {{\"name\": \"{}, {} threads, {} segments\"}}}}",
            separator, ++process, result.name, result.schedule.threads, result.schedule.segments);
        separator = ",\n";
        std::int64_t begin = INT64_MAX;
        for (const auto& thread : result.recording.spans) begin = thread.empty() ? begin : std::min(begin, thread.front().begin);
        for (std::size_t thread = 0; thread < result.recording.spans.size(); ++thread) {
            for (const Span& span : result.recording.spans[thread]) {
                text += fmt::format("{}{{\"name\": \"{}\", \"ph\": \"X\", \"pid\": {}, \"tid\": {}, \"ts\": {:.3f}, \"dur\": {:.3f}}}",
                                    separator, span_name(result.recording, span.what), process, thread,
                                    1e-3 * static_cast<double>(span.begin - begin), 1e-3 * static_cast<double>(span.end - span.begin));
            }
        }
    }
    return text + "\n]}\n";
}

}  // namespace cvtflow::bench
