#include <chrono>

#include "tasks/profile/measure.hpp"

namespace cvtflow::tasks {

namespace {

void nothing(void*, int) noexcept {}

/// Names the only cycle until time is up; the time of each batch of cycles.
class TimedCycles final : public engine::Controller {
public:
    explicit TimedCycles(double seconds) : end_(Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds))) {
        batches_.reserve(most);
    }
    int next() noexcept override {
        if (cycle_++ % batch != 0) return 0;
        const auto now = Clock::now();
        if (cycle_ > batch + 1) batches_.push_back(std::chrono::duration<double>(now - begin_).count() / batch);   // the first batch warms up
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

}  // namespace

double empty_cycle(const Schedule& schedule, double seconds) {
    engine::TaskGraph graph;
    for (int task = 0; task < schedule.threads; ++task) graph.add({"empty", 0, nothing, task, {}});
    graph.freeze();
    TimedCycles controller(seconds);
    make_executor(schedule)->run(graph, nullptr, controller);
    return controller.per_cycle();
}

}  // namespace cvtflow::tasks
