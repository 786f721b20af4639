#include "bench/study/profile/model.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "bench/executor/span_recorder.hpp"

namespace cvtflow::bench {

using namespace tasks;

double even_speed_up(int links, int threads) noexcept {
    const int longest = (links + threads - 1) / threads;
    return static_cast<double>(links) / longest;
}

double amdahl_speed_up(double serial_share, int threads) noexcept { return 1.0 / (serial_share + (1.0 - serial_share) / threads); }

double meeting(const PathCosts& costs, int threads, MeetingLaw law) noexcept {
    if (threads == 1) return 0.0;
    return law == MeetingLaw::linear ? costs.synchronisation + costs.per_thread * threads
                                     : costs.synchronisation_tree + costs.per_doubling * std::log2(threads);
}

double expected_largest(int count) noexcept {
    if (count < 2) return 0.0;
    const double upper = 1.0 - (count - 0.375) / (count + 0.25);  // share of normal numbers above
    double low = 0.0, high = 10.0;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (0.5 * std::erfc(middle / std::sqrt(2.0)) > upper ? low : high) = middle;
    }
    return low;
}

SegmentCost lanes_of(const Segment& segment, const std::vector<bool>& touching, int lanes) {
    SegmentCost cost;
    for (int first = segment.first; first < segment.last; first += lanes) {
        const auto begin = touching.begin() + first, end = touching.begin() + std::min(first + lanes, segment.last);
        (std::find(begin, end, true) == end ? cost.free : cost.touching) += lanes;
    }
    return cost;
}

double step_time(const PathCosts& costs, const Partition& partition, int threads, const std::vector<bool>& touching, double meeting) {
    const int segments = partition.size(), links = static_cast<int>(touching.size());
    const bool alone = threads == 1 && segments == 1;
    double evaluation = 0.0, detection = 0.0;
    for (int thread = 0, first = 0; thread < threads; ++thread) {
        const int last = first + segments / threads + (thread < segments % threads);  // as executors share
        double time = 0.0;
        int thread_links = 0;
        for (int s = first; s < last; ++s) {
            time += alone ? 0.0 : costs.border;
            thread_links += partition[s].size();
            const SegmentCost cost = lanes_of(partition[s], touching, costs.lanes);
            time += costs.free * cost.free + costs.touching * cost.touching;
        }
        evaluation = std::max(evaluation, time);
        detection = std::max(detection, costs.detect * thread_links);
        first = last;
    }
    const double late = costs.jitter * std::sqrt(static_cast<double>(links) / threads) * expected_largest(threads);
    const double stretch = threads == 1 ? 1.0 : costs.stretch, between = costs.controller + (threads == 1 ? 0.0 : meeting);
    return costs.evaluations * (stretch * evaluation + late + between) + stretch * detection + between + costs.other_cycles * between;
}

double predicted_speed_up(const PathCosts& costs, int threads, const std::vector<bool>& touching, MeetingLaw law) {
    const int links = static_cast<int>(touching.size());
    return step_time(costs, Partition::equal(links, 1), 1, touching, 0.0) /
           step_time(costs, Partition::equal(links, threads, Partition::grain(costs.lanes)), threads, touching,
                     meeting(costs, threads, law));
}

void fit_links(std::span<const SegmentCost> samples, PathCosts& costs) {
    const auto total = [&](auto part) {
        double sum = 0.0;
        for (const SegmentCost& sample : samples) sum += part(sample);
        return sum;
    };
    const bool distinct =
        total([](const SegmentCost& s) { return s.free; }) > 0.0 && total([](const SegmentCost& s) { return s.touching; }) > 0.0;
    Eigen::MatrixXd counts(static_cast<Eigen::Index>(samples.size()), distinct ? 3 : 2);
    Eigen::VectorXd times(static_cast<Eigen::Index>(samples.size()));
    for (Eigen::Index row = 0; row < times.size(); ++row) {
        const SegmentCost& sample = samples[static_cast<std::size_t>(row)];
        counts(row, 0) = 1.0;
        counts(row, 1) = distinct ? sample.free : sample.free + sample.touching;
        if (distinct) counts(row, 2) = sample.touching;
        times(row) = sample.seconds;
    }
    Eigen::VectorXd fit = counts.completeOrthogonalDecomposition().solve(times);
    if (fit(0) < 0.0) {  // no border costs less than nothing: once more without
        fit(0) = 0.0;
        fit.tail(fit.size() - 1) = counts.rightCols(fit.size() - 1).completeOrthogonalDecomposition().solve(times);
    }
    costs.border = fit(0);
    costs.free = fit(1);
    costs.touching = distinct ? fit(2) : fit(1);
}

namespace {

/// times ≈ fixed + growth x of(threads), neither below zero.
void fit_law(std::span<const ThreadCost> samples, double (*of)(double), double& fixed, double& growth) {
    Eigen::MatrixXd counts(static_cast<Eigen::Index>(samples.size()), 2);
    Eigen::VectorXd times(static_cast<Eigen::Index>(samples.size()));
    for (Eigen::Index row = 0; row < times.size(); ++row) {
        counts.row(row) << 1.0, of(samples[static_cast<std::size_t>(row)].threads);
        times(row) = samples[static_cast<std::size_t>(row)].seconds;
    }
    if (samples.size() < 2) {
        fixed = samples.empty() ? 0.0 : samples[0].seconds;
        growth = 0.0;
        return;
    }
    const Eigen::VectorXd fit = counts.completeOrthogonalDecomposition().solve(times);
    growth = std::max(0.0, fit(1));
    fixed = std::max(0.0, fit(0));
}

}  // namespace

void fit_synchronisation(std::span<const ThreadCost> samples, PathCosts& costs) {
    fit_law(
        samples, [](double threads) { return threads; }, costs.synchronisation, costs.per_thread);
    fit_law(
        samples, [](double threads) { return std::log2(threads); }, costs.synchronisation_tree, costs.per_doubling);
}

std::vector<SpeedUpRow> speed_up_curves(const PathCosts& costs, double serial_share, const std::vector<bool>& touching, int measured,
                                        int most) {
    const int links = static_cast<int>(touching.size());
    const double serial = step_time(costs, Partition::equal(links, 1), 1, touching, 0.0);
    PathCosts punctual = costs;
    punctual.jitter = 0.0;
    std::vector<SpeedUpRow> rows;
    for (int threads = 1; threads <= std::min(most, links); ++threads) {
        const double farther =
            meeting(costs, threads, MeetingLaw::linear) + (far - 1.0) * costs.per_thread * std::max(0, threads - std::max(1, measured));
        rows.push_back(
            {threads, static_cast<double>(threads), even_speed_up(links, threads), amdahl_speed_up(serial_share, threads),
             predicted_speed_up(costs, threads, touching),
             serial / step_time(costs, Partition::equal(links, threads, Partition::grain(costs.lanes)), threads, touching, farther),
             predicted_speed_up(punctual, threads, touching, MeetingLaw::logarithmic)});
    }
    return rows;
}

namespace {

constexpr double model_cycle_seconds = 0.02;
constexpr int cycle_rounds = 3;

/// Half the distance of quartiles of a normal distribution is 0.6745 standard deviations; quartiles do not see preemption.
double deviation(const std::vector<double>& values) {
    const Spread around = spread(values);
    return (around.upper_quartile - around.lower_quartile) / (2.0 * 0.6745);
}

std::vector<std::vector<double>> task_times(const Spans& spans, int tasks) {
    std::vector<std::vector<double>> times(static_cast<std::size_t>(tasks));
    for (const auto& thread : spans) {
        for (const Span& span : thread) {
            if (span.what >= 0) times[static_cast<std::size_t>(span.what)].push_back(1e-9 * static_cast<double>(span.end - span.begin));
        }
    }
    return times;
}

std::vector<bool> touching_links(const Workspace& workspace) {
    std::vector<bool> touching(static_cast<std::size_t>(workspace.layout().links), false);
    for (std::size_t tip = 0; tip < workspace.tips.phases.size(); ++tip) {
        if (workspace.tips.phases[tip] != model::Phase::free) touching[tip / model::tips_per_link] = true;
    }
    return touching;
}

/// Evaluation tasks of recorded serial runs: median time of each, and the spread of a link's.
struct SegmentSamples {
    std::vector<SegmentCost> segments;
    std::vector<double> jitter;  ///< [s per square root of links]
};

/// Adds the evaluation tasks of a recorded serial run with `segments` segments.
void sample_segments(const Scene& scene, int segments, const MeasureOptions& options, SegmentSamples& samples, ProfileModel& model) {
    Schedule schedule;
    schedule.segments = segments;
    SpanRecorder recorder(1, 200000);
    Trial trial(scene, schedule, &recorder);
    const double per_step = trial.run(4).per_step();
    recorder.clear();
    trial.run(std::min(500L, steps_within(options.round_seconds, per_step)));
    const engine::TaskGraph& graph = trial.simulation().integrator().runner().graph();
    const auto times = task_times({recorder.spans(0)}, graph.size());
    const Workspace& workspace = trial.simulation().workspace();
    model.touching = touching_links(workspace);
    model.costs.lanes = model::lanes_of(workspace.variator.chain().isa());
    double detection = 0.0;
    for (int task = 0; task < graph.size(); ++task) {
        const engine::Task& each = graph.task(task);
        const double time = median(times[static_cast<std::size_t>(task)]);
        if (each.cycle == detect_cycle) detection += time;
        if (each.cycle != evaluate_cycle) continue;
        const Segment& segment = workspace.partition[each.item];
        SegmentCost sample = lanes_of(segment, model.touching, model.costs.lanes);
        sample.seconds = time;
        samples.segments.push_back(sample);
        samples.jitter.push_back(deviation(times[static_cast<std::size_t>(task)]) / std::sqrt(static_cast<double>(segment.size())));
    }
    model.costs.detect = detection / workspace.layout().links;
}

double evaluation_time(const PathCosts& costs, const SegmentCost& segment) {
    return costs.border + costs.free * segment.free + costs.touching * segment.touching;
}

double rms_error(const PathCosts& costs, const std::vector<SegmentCost>& samples) {
    double squares = 0.0, sum = 0.0;
    for (const SegmentCost& sample : samples) {
        squares += std::pow(sample.seconds - evaluation_time(costs, sample), 2);
        sum += sample.seconds;
    }
    return samples.empty() || sum == 0.0 ? 0.0 : std::sqrt(squares * static_cast<double>(samples.size())) / sum;
}

/// Number of runs of the evaluation cycle in a recording of one segment.
double evaluation_cycles(const Recording& recording) {
    double tasks = 0.0, runs = 0.0;
    for (const int cycle : recording.cycles) tasks += cycle == evaluate_cycle ? 1.0 : 0.0;
    for (const auto& thread : recording.spans) {
        for (const Span& span : thread)
            runs += span.what >= 0 && recording.cycles[static_cast<std::size_t>(span.what)] == evaluate_cycle ? 1.0 : 0.0;
    }
    return runs / tasks;
}

double median_controller(const Spans& spans) {
    std::vector<double> times;
    for (const auto& thread : spans) {
        for (const Span& span : thread) {
            if (span.what == engine::span_controller) times.push_back(1e-9 * static_cast<double>(span.end - span.begin));
        }
    }
    return median(times);
}

void measure_synchronisation(ProfileModel& model) {
    std::vector<int> numbers;
    for (int threads = 1; threads <= usable_threads(); threads *= 2) numbers.push_back(threads);
    std::vector<std::vector<double>> costs(numbers.size());
    for (int round = 0; round < cycle_rounds; ++round) {
        for (std::size_t k = 0; k < numbers.size(); ++k) {
            Schedule flow;
            flow.executor = "flow";
            flow.threads = numbers[k];
            const CycleCost cost = cycle_cost(flow, model_cycle_seconds);
            if (cost.active == numbers[k]) costs[k].push_back(cost.seconds);
        }
    }
    for (std::size_t k = 0; k < numbers.size(); ++k) {
        if (!costs[k].empty()) model.synchronisation.push_back({numbers[k], std::max(0.0, median(costs[k]))});
    }
    model.assumed = model.synchronisation.empty() || model.synchronisation.back().threads == 1;
    if (model.assumed) model.synchronisation = {{1, 0.0}, {2, assumed_synchronisation}};
    fit_synchronisation(model.synchronisation, model.costs);
}

Partition partition_of(const ScheduleResult& result, const ProfileModel& model) {
    return Partition::equal(static_cast<int>(model.touching.size()), result.schedule.segments, Partition::grain(model.costs.lanes));
}

/// Measured evaluation tasks over those of the model, all segments together; 0: not recorded on all its threads.
double stretch_of(const ScheduleResult& result, const ProfileModel& model) {
    const Recording& recording = result.recording;
    const int threads = result.schedule.threads;
    if (threads == 1 || result.schedule.assembly.kind != Assembly::fused || result.schedule.balanced || recording.pass.active() < threads)
        return 0.0;
    const std::vector<double> times = median_task_times(recording.spans, static_cast<int>(recording.tasks.size()));
    double measured = 0.0;
    for (std::size_t task = 0; task < times.size(); ++task) measured += recording.cycles[task] == evaluate_cycle ? times[task] : 0.0;
    double expected = 0.0;
    const Partition partition = partition_of(result, model);
    for (const Segment& segment : partition.segments()) {
        expected += evaluation_time(model.costs, lanes_of(segment, model.touching, model.costs.lanes));
    }
    return measured / expected;
}

void measure_stretch(const std::vector<ScheduleResult>& results, ProfileModel& model) {
    std::vector<double> stretches;
    for (const ScheduleResult& result : results) {
        if (const double stretch = stretch_of(result, model); stretch > 0.0) stretches.push_back(stretch);
    }
    model.stretched = !stretches.empty();
    if (model.stretched) model.costs.stretch = median(stretches);
}

double fused_prediction(const ScheduleResult& result, const ProfileModel& model, double own_meeting) {
    return model.serial_step / step_time(model.costs, partition_of(result, model), result.schedule.threads, model.touching, own_meeting);
}

/// Tasks of serial:staged per step, as evenly as whole segments go, the controller's cycles, a meeting per level.
double staged_prediction(const ScheduleResult& result, const ScheduleResult& staged, const ScheduleResult& serial,
                         const ProfileModel& model, double own_meeting) {
    const int threads = result.schedule.threads, segments = result.schedule.segments;
    const double steps = static_cast<double>(result.recording.steps), serial_steps = static_cast<double>(staged.recording.steps);
    if (steps == 0.0 || serial_steps == 0.0) return 0.0;
    const double longest = static_cast<double>((segments + threads - 1) / threads) / segments;
    const double tasks = staged.recording.pass.tasks() / serial_steps * longest * (threads > 1 ? model.costs.stretch : 1.0);
    const double between = (model.costs.controller * result.recording.pass.cycles + own_meeting * result.recording.pass.levels) / steps;
    return serial.loads.front().step.median / (tasks + between);
}

void predict(std::vector<ScheduleResult>& results, const ProfileModel& model) {
    const auto staged =
        std::find_if(results.begin(), results.end(), [](const ScheduleResult& result) { return result.name == "serial:staged"; });
    for (ScheduleResult& result : results) {
        const int threads = result.schedule.threads;
        const double sync = threads == 1                     ? 0.0
                            : result.cycle.active == threads ? std::max(0.0, result.cycle.seconds)
                                                             : meeting(model.costs, threads, MeetingLaw::linear);
        if (result.name.ends_with(":fused")) result.predicted = fused_prediction(result, model, sync);
        if (result.name.ends_with(":staged") && staged != results.end())
            result.predicted = staged_prediction(result, *staged, results.front(), model, sync);
    }
}

}  // namespace

std::vector<double> median_task_times(const Spans& spans, int tasks) {
    std::vector<double> medians;
    for (const auto& each : task_times(spans, tasks)) medians.push_back(median(each));
    return medians;
}

ProfileModel measure_model(const Scene& scene, std::vector<ScheduleResult>& results, const MeasureOptions& options) {
    ProfileModel model;
    const ScheduleResult& serial = results.front();
    const int links = scene.parameters.chain.pins;
    SegmentSamples samples;
    for (const int segments : {24, 7}) sample_segments(scene, std::min(links, segments), options, samples, model);
    fit_links(samples.segments, model.costs);
    model.fit_error = rms_error(model.costs, samples.segments);
    model.costs.jitter = median(samples.jitter);
    model.costs.controller = median_controller(serial.recording.spans);
    model.serial_share = serial.recording.pass.serial_share();
    if (serial.recording.steps > 0) {
        model.costs.evaluations = evaluation_cycles(serial.recording) / static_cast<double>(serial.recording.steps);
        model.costs.other_cycles =
            std::max(0.0, serial.recording.pass.cycles / static_cast<double>(serial.recording.steps) - model.costs.evaluations - 1.0);
    }
    measure_synchronisation(model);
    measure_stretch(results, model);
    model.serial_step = step_time(model.costs, Partition::equal(links, 1), 1, model.touching, 0.0);
    model.curves = speed_up_curves(model.costs, model.serial_share, model.touching, model.synchronisation.back().threads);
    predict(results, model);
    return model;
}

}  // namespace cvtflow::bench
