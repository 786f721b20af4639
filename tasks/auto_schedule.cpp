#include "tasks/auto_schedule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>

#include "tasks/simulation.hpp"

namespace cvtflow::tasks {

namespace {

constexpr double required_gain = 1.05;
constexpr int rounds = 5;
constexpr double round_seconds = 0.02;

/// One candidate at work on its own copy of the start.
class Trial {
public:
    Trial(const Scene& scene, const Schedule& schedule) : simulation_(scene, schedule), candidate_{schedule} {}

    /// Wall time per step over about round_seconds.
    void round() {
        const auto started = std::chrono::steady_clock::now();
        const Fault fault = simulation_.run_steps(steps_, observer_, never_);
        const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
        broken_ = broken_ || (fault && fault.kind != FaultKind::max_steps);
        samples_.push_back(wall / static_cast<double>(steps_));
        steps_ = std::clamp(static_cast<long>(round_seconds / samples_.back()), 4L, 100000L);
    }
    [[nodiscard]] bool broken() const noexcept { return broken_; }
    [[nodiscard]] Candidate result() {
        std::nth_element(samples_.begin(), samples_.begin() + static_cast<std::ptrdiff_t>(samples_.size() / 2), samples_.end());
        candidate_.seconds_per_step = samples_[samples_.size() / 2];
        return candidate_;
    }

private:
    Simulation simulation_;
    Candidate candidate_;
    SilentObserver observer_;
    engine::Cancellation never_;
    std::vector<double> samples_;
    long steps_ = 4;
    bool broken_ = false;
};

std::vector<Schedule> candidates(const Scene& scene) {
    const int links = scene.parameters.chain.pins;
    Schedule serial = schedule_of(scene.run, links);
    const int threads = std::min(serial.threads, links);
    serial.executor = "serial";
    serial.threads = 1;
    if (scene.run.segments == 0) serial.segments = 1;
    std::vector<Schedule> list{serial};
    for (const int per_thread : {1, 2}) {
        Schedule flow = schedule_of(scene.run, links);
        flow.executor = "flow";
        flow.threads = threads;
        if (scene.run.segments == 0) flow.segments = std::min(links, per_thread * threads);
        if (threads > 1 && (per_thread == 1 || scene.run.segments == 0)) list.push_back(flow);
    }
    return list;
}

}  // namespace

Choice choose_schedule(const Scene& scene) {
    const std::vector<Schedule> list = candidates(scene);
    Choice choice{list.front(), {}, "one processor"};
    if (list.size() == 1) return choice;
    std::vector<std::unique_ptr<Trial>> trials;
    for (const Schedule& schedule : list) trials.push_back(std::make_unique<Trial>(scene, schedule));
    for (int round = 0; round <= rounds; ++round) {
        for (const auto& trial : trials) trial->round();
    }
    for (const auto& trial : trials) choice.candidates.push_back(trial->result());
    const auto faster = [](const Candidate& a, const Candidate& b) { return a.seconds_per_step < b.seconds_per_step; };
    const Candidate& best = *std::min_element(choice.candidates.begin() + 1, choice.candidates.end(), faster);
    const double serial = choice.candidates.front().seconds_per_step;
    const bool worth = serial > required_gain * best.seconds_per_step;
    if (worth) choice.schedule = best.schedule;
    choice.reason = fmt::format("measured: serial {:.1f} us per step, {} {:.1f} us{}", 1e6 * serial, best.schedule.text(), 1e6 * best.seconds_per_step,
                                worth ? "" : ", not worth it");
    return choice;
}

Schedule schedule_for(const Scene& scene) {
    if (scene.run.schedule != "auto") return schedule_of(scene.run, scene.parameters.chain.pins);
    return choose_schedule(scene).schedule;
}

}  // namespace cvtflow::tasks
