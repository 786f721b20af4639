#include "bench/study/granularity/granularity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "bench/study/profile/other_load.hpp"
#include "engine/executor/catalogue.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/schedule/schedule.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

using Clock = std::chrono::steady_clock;

double passed(Clock::time_point since) { return std::chrono::duration<double>(Clock::now() - since).count(); }

/// Data of a task: a separate cache line.
struct alignas(128) Grain {
    double value = 1.0;
    long length = 0;  ///< iterations
};

/// Arithmetic that depends on itself, so that its time is its number of instructions.
void grind(void* context, int item) noexcept {
    Grain& piece = static_cast<Grain*>(context)[item];
    double x = piece.value;
    for (long i = 0; i < piece.length; ++i) x = x * 0.999999 + 1e-6;
    piece.value = x;
}

/// Time of an iteration on an idle processor: the least of many tries [s]. Called like by executors: a compiler that finds the result
/// unused omits the work.
double iteration_time() {
    const engine::TaskGraph graph = stencil_graph(1, 1);
    Grain probe{1.0, 20000};
    double least = 1.0;
    for (int attempt = 0; attempt < 200; ++attempt) {
        const auto begin = Clock::now();
        graph.call(0)(&probe);
        least = std::min(least, passed(begin));
    }
    return least / static_cast<double>(probe.length);
}

/// Cycles until the work is done or the timeout has passed; those of the first millisecond bring threads together and do not count.
class WorkedCycles final : public engine::Controller {
public:
    WorkedCycles(long cycles, double timeout) : requested_(cycles), timeout_(timeout) {}
    int next() noexcept override {
        constexpr double arrival = 1e-3;
        if (done_ < 0 && passed(begin_) < arrival) return 0;
        if (done_ < 0) begin_ = Clock::now();
        ++done_;
        const double seconds = passed(begin_);
        if (done_ < requested_ && (done_ == 0 || seconds < timeout_)) return 0;
        per_cycle_ = seconds / static_cast<double>(done_);
        return stop;
    }
    [[nodiscard]] double per_cycle() const noexcept { return per_cycle_; }

private:
    long requested_, done_ = -1;
    double timeout_, per_cycle_ = 0.0;
    Clock::time_point begin_ = Clock::now();
};

/// Everything that is measured on levels of one number of tasks of one length.
struct Setting {
    int tasks;
    double length;  ///< [s]
    std::shared_ptr<engine::TaskGraph> graph;
    std::vector<Grain> grains;
    long cycles;
    std::vector<double> bare;  ///< time of a cycle of the bare loop, per round [s]
};

struct Contender {
    const engine::ExecutorRow* row;
    int threads;
    std::unique_ptr<engine::Executor> executor;
};

std::vector<Contender> contenders(const GranularityOptions& options) {
    std::vector<std::string> names = options.executors;
    if (names.empty()) {
        for (const engine::ExecutorRow& row : engine::executors()) names.emplace_back(row.name);
    }
    std::vector<Contender> all;
    for (const std::string& name : names) {
        const engine::ExecutorRow* row = engine::find_executor(name);
        if (row == nullptr) {
            throw SceneError(
                fmt::format("--executors: there is no executor '{}'{} (cvtflow-lab executors)", name, engine::missing_executor(name)));
        }
        const int threads = !row->parallel ? 1 : options.threads > 0 ? options.threads : usable_threads();
        all.push_back({row, threads, row->make({.threads = threads, .wait = options.wait, .pin = options.pin})});
    }
    return all;
}

std::vector<Setting> settings(const GranularityOptions& options) {
    const double iteration = iteration_time();
    std::vector<Setting> all;
    for (const int tasks : options.tasks) {
        const auto graph = std::make_shared<engine::TaskGraph>(stencil_graph(options.levels, tasks));
        for (const double length : options.lengths) {
            if (!(length > 0.0)) throw std::invalid_argument("granularity: lengths are positive");
            const Grain grain{1.0, std::max(1L, std::lround(length / iteration))};
            const double cycle = length * options.levels * tasks;
            all.push_back({tasks,
                           length,
                           graph,
                           std::vector<Grain>(static_cast<std::size_t>(graph->size()), grain),
                           std::max(1L, std::lround(options.work / cycle)),
                           {}});
        }
    }
    return all;
}

/// Time of a cycle's work in a bare loop [s].
double bare_cycle(Setting& setting, double timeout) {
    const auto order = setting.graph->topological(0);
    const auto begin = Clock::now();
    long cycles = 0;
    while (cycles < setting.cycles && (cycles == 0 || passed(begin) < timeout)) {
        for (const int task : order) setting.graph->call(task)(setting.grains.data());
        ++cycles;
    }
    return passed(begin) / static_cast<double>(cycles);
}

/// [setting][contender][round]
using Times = std::vector<std::vector<std::vector<double>>>;

void measure_round(std::vector<Setting>& all, const std::vector<Contender>& executors, const GranularityOptions& options, Times& times) {
    for (std::size_t s = 0; s < all.size(); ++s) {
        all[s].bare.push_back(bare_cycle(all[s], options.timeout));
        for (std::size_t e = 0; e < executors.size(); ++e) {
            WorkedCycles controller(all[s].cycles, options.timeout);
            executors[e].executor->run(*all[s].graph, all[s].grains.data(), controller);
            times[s][e].push_back(controller.per_cycle());
            executors[e].executor->release_threads();
        }
    }
}

GranularityPoint point(const Setting& setting, const Contender& contender, const std::vector<double>& times) {
    const double share = ideal_share(setting.tasks, contender.threads);
    std::vector<double> efficiency, ideal;
    for (std::size_t round = 0; round < times.size(); ++round) {
        ideal.push_back(setting.bare[round] * share);
        efficiency.push_back(ideal.back() / times[round]);
    }
    return {std::string(contender.row->name),
            contender.threads,
            setting.tasks,
            setting.length,
            median(times),
            median(ideal),
            spread(efficiency)};
}

}  // namespace

engine::TaskGraph stencil_graph(int levels, int tasks) {
    if (levels < 1 || tasks < 1) throw std::invalid_argument("granularity: a stencil has at least one level and one task");
    engine::TaskGraph graph;
    for (int level = 0; level < levels; ++level) {
        for (int task = 0; task < tasks; ++task) graph.add({fmt::format("t[{}]", task), 0, grind, level * tasks + task, {}});
        for (int task = 0; level > 0 && task < tasks; ++task) {
            const int before = (level - 1) * tasks;
            for (const int neighbour : {task + tasks - 1, task, task + 1}) graph.order(before + neighbour % tasks, level * tasks + task);
        }
    }
    graph.freeze();
    return graph;
}

double ideal_share(int tasks, int threads) noexcept {
    const int rounds = (tasks + threads - 1) / threads;
    return static_cast<double>(rounds) / tasks;
}

double effective_granularity(std::span<const GranularityPoint> curve, double share) noexcept {
    const auto low = std::find_if(curve.rbegin(), curve.rend(), [=](const GranularityPoint& p) { return p.efficiency.median < share; });
    if (low == curve.rbegin()) return std::numeric_limits<double>::infinity();
    if (low == curve.rend()) return curve.front().length;
    const GranularityPoint &below = *low, &above = *(low - 1);
    const double part = (share - below.efficiency.median) / (above.efficiency.median - below.efficiency.median);
    return below.length * std::pow(above.length / below.length, part);
}

bool Granularity::crowded() const noexcept { return calibrated < crowded_below * requested; }

std::vector<std::string> Granularity::executors() const {
    std::vector<std::string> names;
    for (const GranularityPoint& point : points) {
        if (std::find(names.begin(), names.end(), point.executor) == names.end()) names.push_back(point.executor);
    }
    return names;
}

std::vector<int> Granularity::tasks() const {
    std::vector<int> numbers;
    for (const GranularityPoint& point : points) {
        if (std::find(numbers.begin(), numbers.end(), point.tasks) == numbers.end()) numbers.push_back(point.tasks);
    }
    return numbers;
}

std::vector<GranularityPoint> Granularity::curve(const std::string& executor, int tasks) const {
    std::vector<GranularityPoint> chosen;
    for (const GranularityPoint& point : points) {
        if (point.executor == executor && point.tasks == tasks) chosen.push_back(point);
    }
    return chosen;
}

Granularity measure_granularity(const GranularityOptions& options, const std::function<void(const std::string&)>& progress) {
    constexpr double calibration = 0.05;  // [s]
    const std::vector<Contender> executors = contenders(options);
    std::vector<Setting> all = settings(options);
    Granularity result;
    for (const Contender& each : executors) result.requested = std::max(result.requested, std::min(each.threads, usable_threads()));
    result.calibrated = processors_got(result.requested, calibration);
    Times times(all.size(), std::vector<std::vector<double>>(executors.size()));
    for (int round = 0; round < options.rounds; ++round) {
        if (progress) progress(fmt::format("round {} of {}", round + 1, options.rounds));
        measure_round(all, executors, options, times);
    }
    result.calibrated = std::min(result.calibrated, processors_got(result.requested, calibration));
    for (std::size_t s = 0; s < all.size(); ++s) {
        for (std::size_t e = 0; e < executors.size(); ++e) result.points.push_back(point(all[s], executors[e], times[s][e]));
    }
    return result;
}

}  // namespace cvtflow::bench
