#include "bench/study/profile/measure.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <limits>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "bench/executor/span_recorder.hpp"
#include "bench/study/profile/bare_barrier.hpp"
#include "bench/study/profile/other_load.hpp"
#include "bench/study/profile/statistics.hpp"
#include "engine/base/hash.hpp"

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

void Trial::settle() {
    if (!simulation_.needs_settling()) return;
    DeadlineObserver observer(std::numeric_limits<double>::infinity());
    if (const Fault fault = simulation_.advance({.until = 0.0, .max_wall = 0.0}, observer, observer.cancellation()))
        throw SimulationError(fault.message());
}

TrialSample Trial::run(long steps, double timeout) {
    const double cpu = processor_seconds();
    DeadlineObserver observer(timeout);
    const bool anew = !begun_ || simulation_.needs_settling();
    const Counters before = anew ? Counters{} : simulation_.counters();
    const Fault fault = simulation_.advance({.steps = steps, .new_part = anew, .max_wall = 0.0}, observer, observer.cancellation());
    begun_ = true;
    const double wall = observer.waited();
    const double used = processor_seconds() - cpu;
    simulation_.integrator().runner().release_threads();  // they do not disturb the next schedule's turn
    if (fault && fault.kind != FaultKind::max_steps && fault.kind != FaultKind::cancelled) throw SimulationError(fault.message());
    const Counters& after = simulation_.counters();
    return {wall, used, after.steps - before.steps, after.evaluations - before.evaluations};
}

long steps_within(double seconds, double per_step) noexcept { return static_cast<long>(std::clamp(seconds / per_step, 1.0, 1e5)); }

namespace {

/// Arithmetic that depends on itself, so that its time is its length; each task has a separate cache line.
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

namespace {

constexpr long first_steps = 4;
constexpr long more_steps = 36;
constexpr double cycle_seconds = 0.01;  // seconds of a turn of bare cycles
constexpr long max_stamps = 500000;     // stamps per thread: 12 MB

/// Samples of one lane under one load.
struct Samples {
    std::vector<double> step, evaluation, busy, cpu;
    long steps = first_steps;
    std::string dropped;

    void add(const TrialSample& sample, double neighbours_cpu) {
        step.push_back(sample.per_step());
        evaluation.push_back(sample.wall / static_cast<double>(sample.evaluations));
        const double run_cpu = std::max(0.0, sample.cpu - neighbours_cpu);
        busy.push_back(run_cpu / sample.wall);
        cpu.push_back(run_cpu / static_cast<double>(sample.steps));
    }
};

/// One turn; the first calibrates, the second warms up.
void turn(ScheduleTrial& lane, Samples& samples, const MeasureOptions& options, int round, const BusyNeighbours& neighbours) {
    const double before = neighbours.processor_seconds();
    const TrialSample sample = lane.trial->run(samples.steps, options.timeout);
    const double neighbours_cpu = neighbours.processor_seconds() - before;
    samples.steps = options.steps > 0 ? options.steps : steps_within(options.round_seconds, sample.per_step());
    const bool slow = sample.wall > options.timeout || sample.per_step() * static_cast<double>(samples.steps) > options.timeout;
    if (round > 0 || slow) samples.add(sample, neighbours_cpu);
    if (slow) samples.dropped = fmt::format("dropped: {} steps took {:.1f} s", sample.steps, sample.wall);
}

LoadResult load_result(const Samples& samples, int neighbours) {
    return {neighbours,
            spread(samples.step),
            median(samples.evaluation),
            median(samples.busy),
            0.0,
            static_cast<int>(samples.step.size()),
            samples.dropped,
            median(samples.cpu),
            0.0};
}

/// Time of a bare barrier [s].
double bare_cycle(int threads) {
    constexpr double any_wait = std::numeric_limits<double>::infinity();
    const double seconds = bare_barrier_cycle(threads, 0.5 * cycle_seconds, any_wait);
    if (std::isinf(seconds)) too_few_threads(threads);
    return seconds;
}

/// Synchronisation alone, right before the schedule's turn.
void cycle_turn(ScheduleTrial& lane) {
    lane.cycles.push_back(cycle_cost(lane.result.schedule, cycle_seconds));
    lane.bare.push_back(bare_cycle(lane.result.schedule.threads));
}

void copies_turn(CopiesTrial& copies, long steps, double timeout) {
    copies.bare.push_back(bare_cycle(copies.result.threads));
    std::vector<std::future<double>> times;
    for (const auto& trial : copies.trials)
        times.push_back(std::async(std::launch::async, [&trial, steps, timeout] { return trial->run(steps, timeout).per_step(); }));
    double rate = 0.0;
    for (std::future<double>& time : times) rate += 1.0 / time.get();
    copies.step.push_back(1.0 / rate);
}

/// Medians over the rounds in which all threads came; if they mostly did not, the cost means nothing and `active` gives the reason.
void sum_up_cycles(ScheduleTrial& lane) {
    std::vector<double> seconds, active;
    for (const CycleCost& cost : lane.cycles) {
        active.push_back(cost.active);
        if (cost.active == lane.result.schedule.threads) seconds.push_back(cost.seconds);
    }
    const bool mostly = 2 * seconds.size() > lane.cycles.size();
    lane.result.cycle = {median(seconds), mostly ? lane.result.schedule.threads : static_cast<int>(median(active))};
    lane.result.bare = median(lane.bare);
}

}  // namespace

std::string schedule_name(const Schedule& schedule) { return schedule.executor + ":" + assembly_name(schedule.assembly); }

std::vector<std::string> hash_differences(const std::vector<ScheduleResult>& results, std::uint64_t short_hash) {
    std::vector<std::string> lines;
    for (const ScheduleResult& result : results) {
        const std::uint64_t expected = result.hash_steps == first_steps ? short_hash : results.front().hash;
        if (result.hash == expected) continue;
        lines.push_back(fmt::format("{} with {} segments and {} threads: state {} after {} steps, serial has {}", result.name,
                                    result.schedule.segments, result.schedule.threads, engine::hex(result.hash), result.hash_steps,
                                    engine::hex(expected)));
    }
    return lines;
}

std::vector<ScheduleTrial> start_lanes(const Scene& scene, const std::vector<Schedule>& schedules, double timeout,
                                       std::uint64_t& short_hash) {
    std::vector<ScheduleTrial> lanes;
    for (const Schedule& schedule : schedules) {
        ScheduleTrial lane;
        lane.trial = std::make_unique<Trial>(scene, schedule);
        lane.result.schedule = schedule;
        lane.result.name = schedule_name(schedule);
        const TrialSample sample = lane.trial->run(first_steps);
        lane.result.hash = lane.trial->simulation().hash();
        lane.result.hash_steps = first_steps;
        if (lanes.empty()) short_hash = lane.result.hash;
        if (lanes.empty() || sample.per_step() * more_steps < timeout) {
            lane.trial->run(more_steps);
            lane.result.hash = lane.trial->simulation().hash();
            lane.result.hash_steps += more_steps;
        }
        lanes.push_back(std::move(lane));
    }
    return lanes;
}

PairedGain paired_gain(const std::vector<double>& serial, const std::vector<double>& step, const std::vector<double>& bare, int rounds) {
    std::vector<double> near, far;
    if (serial.size() < static_cast<std::size_t>(rounds) || step.size() < bare.size()) return {};
    const auto first_serial = serial.end() - rounds;
    const auto first_step = step.end() - static_cast<std::ptrdiff_t>(bare.size());
    for (std::ptrdiff_t round = 0; round < static_cast<std::ptrdiff_t>(bare.size()); ++round)
        (bare[static_cast<std::size_t>(round)] <= near_meeting ? near : far).push_back(first_serial[round] / first_step[round]);
    return {spread(near), spread(far), static_cast<int>(near.size()), static_cast<int>(far.size())};
}

std::vector<CopiesTrial> start_copies(const Scene& scene, const std::vector<Schedule>& schedules) {
    std::set<int> numbers;
    for (const Schedule& schedule : schedules) {
        if (schedule.threads > 1 && schedule.threads <= usable_threads()) numbers.insert(schedule.threads);
    }
    std::vector<CopiesTrial> all;
    for (const int threads : numbers) {
        CopiesTrial copies;
        copies.result.threads = threads;
        for (int k = 0; k < threads; ++k) {
            copies.trials.push_back(std::make_unique<Trial>(scene, Schedule{}));
            copies.trials.back()->run(first_steps + more_steps);
        }
        all.push_back(std::move(copies));
    }
    return all;
}

void measure_load(std::vector<ScheduleTrial>& lanes, std::vector<CopiesTrial>& copies, const MeasureOptions& options, int neighbours) {
    const BusyNeighbours busy(neighbours);
    std::vector<Samples> samples(lanes.size());
    for (int round = -1; round <= options.rounds; ++round) {
        const bool meets = neighbours == 0 && round > 0;
        for (std::size_t k = 0; k < lanes.size(); ++k) {
            if (lanes[k].dropped) continue;
            if (meets) cycle_turn(lanes[k]);
            turn(lanes[k], samples[k], options, round, busy);
            lanes[k].dropped = k > 0 && !samples[k].dropped.empty();
        }
        for (CopiesTrial& each : copies) {
            if (meets) copies_turn(each, samples.front().steps, options.timeout);
        }
    }
    const std::vector<double>& serial_steps = samples.front().step;
    for (CopiesTrial& each : copies) {
        if (neighbours == 0) each.result.paired = paired_gain(serial_steps, each.step, each.bare, options.rounds);
    }
    for (std::size_t k = 0; k < lanes.size(); ++k) {
        if (samples[k].step.empty()) samples[k].dropped = "dropped under a lighter load";
        LoadResult result = load_result(samples[k], neighbours);
        const double serial = k == 0 ? result.step.median : lanes.front().result.loads.back().step.median;
        result.speed_up = result.rounds == 0 ? 0.0 : serial / result.step.median;
        if (k > 0 && result.rounds > 0) result.burnt = result.cpu - lanes.front().result.loads.back().cpu;
        if (neighbours == 0) {
            sum_up_cycles(lanes[k]);
            lanes[k].result.paired = paired_gain(serial_steps, samples[k].step, lanes[k].bare, options.rounds);
        }
        lanes[k].result.loads.push_back(result);
    }
}

namespace {

/// Twice the stamps of the first steps, all threads together: one thread may do it all, and transitions and iterations repeat cycles.
int stamps_of_a_step(const Scene& scene, const Schedule& schedule) {
    SpanRecorder recorder(schedule.threads, 64);  // counts what it does not keep
    Trial probe(scene, schedule, &recorder);
    const long steps = probe.run(first_steps).steps;
    long stamps = 0;
    for (int thread = 0; thread < recorder.threads(); ++thread)
        stamps += static_cast<long>(recorder.spans(thread).size()) + recorder.lost(thread);
    return static_cast<int>(2 * stamps / std::max(1L, steps)) + 32;
}

}  // namespace

StageTable stages_of(const std::vector<ScheduleTrial>& lanes) {
    StageTable stages;
    for (const ScheduleTrial& lane : lanes) stages.add(lane.trial->simulation().integrator().runner().graph());
    return stages;
}

void record_lane(const Scene& scene, ScheduleTrial& lane, const MeasureOptions& options, const StageTable& stages) {
    Recording& recording = lane.result.recording;
    const engine::TaskGraph& graph = lane.trial->simulation().integrator().runner().graph();
    const double per_step = lane.result.loads.front().step.median;
    if (lane.dropped || per_step <= 0.0) return;
    const int stamps = stamps_of_a_step(scene, lane.result.schedule);
    recording.steps = std::clamp(options.steps > 0 ? options.steps : steps_within(options.round_seconds, per_step), 1L,
                                 std::max(1L, std::min(100L, max_stamps / stamps)));
    SpanRecorder recorder(lane.result.schedule.threads, static_cast<int>(recording.steps) * stamps);
    Trial recorded(scene, lane.result.schedule, &recorder);
    recorded.run(first_steps);
    struct Kept {
        double seconds;
        Spans spans;
        long lost;
    };
    std::vector<Kept> kept;
    std::vector<double> bare;
    for (int round = 0; round < std::max(3, options.rounds); ++round) {
        bare.push_back(lane.trial->run(recording.steps).per_step());
        recorder.clear();
        Kept now{recorded.run(recording.steps).per_step(), {}, 0};
        for (int thread = 0; thread < recorder.threads(); ++thread) {
            now.spans.push_back(recorder.spans(thread));
            now.lost += recorder.lost(thread);
        }
        kept.push_back(std::move(now));
    }
    std::sort(kept.begin(), kept.end(), [](const Kept& a, const Kept& b) { return a.seconds < b.seconds; });
    Kept& middle = kept[kept.size() / 2];
    recording.cost = middle.seconds / median(bare) - 1.0;
    recording.lost = middle.lost;
    recording.spans = std::move(middle.spans);
    recording.pass = sum_up(graph, stages, recording.spans);
    for (int task = 0; task < graph.size(); ++task) recording.tasks.push_back(graph.task(task).name);
}

}  // namespace cvtflow::bench
