#include "tasks/profile/trial.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>

namespace cvtflow::tasks {

namespace {

class Nobody final : public RunObserver {
    void output(double, const Workspace&, const Counters&) override {}
    void transition(const TransitionRecord&) override {}
};

double processor_seconds() {
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    const auto seconds = [](const timeval& time) { return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec); };
    return seconds(used.ru_utime) + seconds(used.ru_stime);
}

}  // namespace

Trial::Trial(const Scene& scene, const Schedule& schedule, engine::StampRecorder* recorder) : simulation_(scene, schedule, recorder) {}

TrialSample Trial::run(long steps) {
    Nobody nobody;
    const double cpu = processor_seconds();
    const auto started = std::chrono::steady_clock::now();
    const Fault fault = simulation_.run_steps(steps, nobody, never_);
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    if (fault && fault.kind != FaultKind::max_steps) throw SimulationError(fault.message());
    return {wall, processor_seconds() - cpu, steps, simulation_.counters().evaluations};
}

long steps_within(double seconds, double per_step) noexcept { return static_cast<long>(std::clamp(seconds / per_step, 1.0, 1e5)); }

}  // namespace cvtflow::tasks
