#include "tasks/schedule/schedule.hpp"

#include <algorithm>

namespace cvtflow::tasks {

namespace {

void add_once(std::vector<Schedule>& list, const Schedule& schedule) {
    if (std::find(list.begin(), list.end(), schedule) == list.end()) list.push_back(schedule);
}

}  // namespace

int max_segments(const model::Parameters& parameters) noexcept {
    return parameters.detail.pins == model::PinDetail::rigid ? 1 : parameters.chain.pins;
}

std::vector<Schedule> schedules_for(const Scene& scene) {
    const int links = max_segments(scene.parameters);
    Schedule serial = schedule_of(scene.run, links);
    if (scene.run.schedule != "auto") return {serial};
    Schedule flow = serial;
    flow.executor = "flow";
    flow.threads = std::min(serial.threads, links);
    serial.executor = "serial";
    serial.threads = 1;
    serial.balanced = false;
    if (scene.run.segments == 0) serial.segments = 1;
    std::vector<Schedule> list{serial};
    if (flow.threads == 1) return list;
    const auto segments = [&](int requested) { return scene.run.segments > 0 ? scene.run.segments : std::min(links, requested); };
    flow.segments = segments(flow.threads);
    add_once(list, flow);
    Schedule other = flow;
    other.balanced = true;
    add_once(list, other);
    other = flow;
    other.segments = segments(2 * flow.threads);
    add_once(list, other);
    other = flow;
    other.assembly = {Assembly::staged};
    if (has_assembly(Assembly::staged) && scene.parameters.detail.pins == model::PinDetail::halves) add_once(list, other);
    for (other = flow, other.balanced = true; other.threads >= 4;) {
        other.threads /= 2;
        other.segments = segments(other.threads);
        add_once(list, other);
    }
    return list;
}

}  // namespace cvtflow::tasks
