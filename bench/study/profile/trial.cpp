#include "bench/study/profile/trial.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>

namespace cvtflow::bench {

using namespace tasks;

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

/// Ends a run that takes too long.
class DeadlineObserver final : public RunObserver {
public:
    explicit DeadlineObserver(double timeout) : timeout_(timeout) {}
    [[nodiscard]] const engine::Cancellation& cancellation() const noexcept { return cancellation_; }
    [[nodiscard]] double waited() const { return seconds_since(begin_); }

private:
    void output(double, const Workspace&, const Counters&) override {
        if (waited() > timeout_) cancellation_.request();
    }
    void transition(const TransitionRecord&) override {}

    double timeout_;
    Clock::time_point begin_ = Clock::now();
    engine::Cancellation cancellation_;
};

double processor_seconds() {
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    const auto seconds = [](const timeval& time) { return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec); };
    return seconds(used.ru_utime) + seconds(used.ru_stime);
}

}  // namespace

Trial::Trial(const Scene& scene, const Schedule& schedule, engine::StampRecorder* recorder) : simulation_(scene, schedule, recorder) {}

TrialSample Trial::run(long steps, double timeout) {
    const double cpu = processor_seconds();
    DeadlineObserver observer(timeout);
    const bool anew = !begun_ || simulation_.needs_settling();
    const Counters before = anew ? Counters{} : simulation_.counters();
    const Fault fault = simulation_.advance({.steps = steps, .new_part = anew, .max_wall = 0.0}, observer, observer.cancellation());
    begun_ = true;
    const double wall = observer.waited();
    const double used = processor_seconds() - cpu;
    simulation_.integrator().runner().release_threads();  // the next schedule's turn is its own
    if (fault && fault.kind != FaultKind::max_steps && fault.kind != FaultKind::cancelled) throw SimulationError(fault.message());
    const Counters& after = simulation_.counters();
    return {wall, used, after.steps - before.steps, after.evaluations - before.evaluations};
}

long steps_within(double seconds, double per_step) noexcept { return static_cast<long>(std::clamp(seconds / per_step, 1.0, 1e5)); }

}  // namespace cvtflow::bench
