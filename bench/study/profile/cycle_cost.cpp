#include "bench/study/profile/cycle_cost.hpp"

#include <algorithm>
#include <chrono>
#include <vector>

#include "bench/executor/span_recorder.hpp"
#include "bench/study/profile/statistics.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

/// Arithmetic that depends on itself, so that its time is its length; each task has a line of its own.
struct alignas(128) Work {
    double value = 1.0;
};

void work(void* context, int item) noexcept {
    constexpr int length = 650;
    double x = static_cast<Work*>(context)[item].value;
    for (int i = 0; i < length; ++i) x = x * 0.999999 + 1e-6;
    static_cast<Work*>(context)[item].value = x;
}

/// Names the only cycle until time is up; keeps the time of each batch of cycles.
class TimedCycles final : public engine::Controller {
public:
    explicit TimedCycles(double seconds)
        : end_(Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds))) {
        batches_.reserve(most);
    }
    int next() noexcept override {
        if (cycle_++ % batch != 0) return 0;
        const auto now = Clock::now();
        if (cycle_ > batch + 1)
            batches_.push_back(std::chrono::duration<double>(now - begin_).count() / batch);  // the first batch warms up
        begin_ = now;
        return (now > end_ && !batches_.empty()) || batches_.size() == most ? stop : 0;
    }
    [[nodiscard]] double per_cycle() const { return median(batches_); }

private:
    using Clock = std::chrono::steady_clock;
    static constexpr long batch = 16;
    static constexpr std::size_t most = 10000;
    Clock::time_point end_, begin_;
    long cycle_ = 0;
    std::vector<double> batches_;
};

/// Time per cycle [s]. Stamps are taken with and without threads alike, so that their cost cancels.
double per_cycle(const Schedule& schedule, double seconds, SpanRecorder& recorder) {
    engine::TaskGraph graph;
    std::vector<Work> data(static_cast<std::size_t>(schedule.threads));
    for (int task = 0; task < schedule.threads; ++task) graph.add({"work", 0, work, task, {}});
    graph.freeze();
    TimedCycles controller(seconds);
    const auto executor = make_executor(schedule, &recorder);
    executor->run(graph, data.data(), controller);
    executor->release_threads();
    return controller.per_cycle();
}

int active_threads(const SpanRecorder& recorder) {
    std::vector<double> tasks;
    double all = 0.0;
    for (int thread = 0; thread < recorder.threads(); ++thread) {
        const auto spans = recorder.spans(thread);
        const auto kept = std::count_if(spans.begin(), spans.end(), [](const Span& span) { return span.what >= 0; });
        tasks.push_back(static_cast<double>(kept == 0 ? 0 : kept + recorder.lost(thread)));
        all += tasks.back();
    }
    const double enough = 0.25 * all / recorder.threads();
    return static_cast<int>(std::count_if(tasks.begin(), tasks.end(), [=](double count) { return count > 0.0 && count >= enough; }));
}

}  // namespace

CycleCost cycle_cost(const Schedule& schedule, double seconds) {
    constexpr int kept = 4096;
    SpanRecorder alone(1, kept), all(schedule.threads, kept);
    const double task = per_cycle(Schedule{}, 0.5 * seconds, alone);
    const double cycle = per_cycle(schedule, 0.5 * seconds, all);
    return {cycle - task, active_threads(all)};
}

}  // namespace cvtflow::bench
