/// Cost of the synchronisation of one cycle: every executor on empty tasks, and on two tasks of 2.6 µs, the cost above the ideal.
/// Beside them a hand-made barrier of as many spinning threads, the least that is possible; and the cost of time stamps on a task of 5 µs.
/// A plain program, because executors must alternate within one process and medians be taken over repetitions: on a machine with
/// neighbours nothing else can be compared.
///
/// Committed figures come from `bench_synchronisation --repetitions 31 --csv FILE` with OMP_WAIT_POLICY=active on a quiet machine.
///
///     bench_synchronisation [--repetitions N] [--threads N] [--wait spin|balanced|passive] [--pin yes|no] [--csv FILE]
///
/// Threads are pinned by default: a system with other load often puts both on one processor, and the other load is measured instead.

#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <numeric>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "bench/executor/further_executors.hpp"
#include "bench/executor/span_recorder.hpp"
#include "engine/base/provenance.hpp"
#include "engine/executor/catalogue.hpp"
#include "engine/thread/pinning.hpp"
#include "engine/thread/worker_threads.hpp"

namespace {

using namespace cvtflow::engine;

struct Settings {
    int repetitions = 15;
    int threads = 2;
    Wait wait = Wait::balanced;
    std::string wait_name = "balanced";
    std::string csv;
    bool pin = true;
};

/// One turn of a contender [µs per cycle].
struct Turn {
    double typical;  ///< median over its cycles: cost of an undisturbed cycle
    double mean;     ///< mean of the turn's time: interference included
};

/// Arithmetic that depends on itself, so that its time is its length; each task has a separate cache line.
struct alignas(128) Work {
    double value = 1.0;
    long length = 0;
};

void work(void* context, int item) noexcept {
    Work& own = static_cast<Work*>(context)[item];
    double x = own.value;
    for (long i = 0; i < own.length; ++i) x = x * 0.999999 + 1e-6;
    own.value = x;
}

/// Cycles for 20 ms, each of them timed (9 ns for the clock), without the first 4 ms: when a run begins, threads are still on their way. On
/// a busy machine longer, up to 300 ms, until there are enough to have a median that is not the neighbours'.
class Cycles final : public Controller {
public:
    explicit Cycles(const cvtflow::bench::TickScale& scale) : per_tick_(1e-3 * scale.nanoseconds_per_tick()) { times_.reserve(most); }

    int next() noexcept override {
        const std::int64_t now = ticks(), last = std::exchange(last_, now);
        if (now < from_) return 0;
        if (times_.size() == most || now > limit_ || (now > until_ && times_.size() >= enough)) return stop;
        if (last >= from_) times_.push_back(static_cast<double>(now - last));
        return 0;
    }
    [[nodiscard]] Turn turn() {
        if (times_.empty()) times_.push_back(static_cast<double>(last_ - begin_));
        const double sum = std::accumulate(times_.begin(), times_.end(), 0.0), count = static_cast<double>(times_.size());
        std::nth_element(times_.begin(), times_.begin() + static_cast<long>(times_.size()) / 2, times_.end());
        return {times_[times_.size() / 2] * per_tick_, sum / count * per_tick_};
    }

private:
    static constexpr std::size_t most = 200000, enough = 1000;
    double per_tick_;  // [µs]
    std::int64_t begin_ = ticks(), last_ = begin_;
    std::int64_t from_ = begin_ + static_cast<std::int64_t>(4e3 / per_tick_), until_ = begin_ + static_cast<std::int64_t>(20e3 / per_tick_);
    std::int64_t limit_ = begin_ + static_cast<std::int64_t>(300e3 / per_tick_);
    std::vector<double> times_;
};

double microseconds(const std::function<void()>& action) {
    const auto begin = std::chrono::steady_clock::now();
    action();
    return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
}

/// Iterations of `work` that take that long on a quiet processor: the least of many tries.
long length_of(double target) {
    Work probe{1.0, 20000};
    double least = 1e9;
    for (int i = 0; i < 200; ++i) least = std::min(least, microseconds([&] { work(&probe, 0); }));
    return static_cast<long>(target / least * static_cast<double>(probe.length));
}

/// A counter that others read, on separate cache lines.
struct alignas(128) Counter {
    std::atomic<long> value{0};
};

/// Threads with a contiguous share of the tasks each, one counter each: the first opens a cycle, the others answer.
Turn bare_barrier(std::vector<Work>& data, const cvtflow::bench::TickScale& scale, const Settings& settings) {
    const Processors processors;
    const Pin own(settings.pin, processors, 0);
    const int tasks = static_cast<int>(data.size()), members = std::min(settings.threads, tasks);
    const auto run_share = [&](int member) {
        for (int task = tasks * member / members; task < tasks * (member + 1) / members; ++task) work(data.data(), task);
    };
    Counter opened;
    std::vector<Counter> answered(static_cast<std::size_t>(members));
    std::vector<std::jthread> others;
    for (int member = 1; member < members; ++member) {
        others.emplace_back([&, member] {
            const Pin pinned(settings.pin, processors, member);
            for (long cycle = 1;; ++cycle) {
                long now = opened.value.load(std::memory_order_acquire);
                for (; now >= 0 && now < cycle; now = opened.value.load(std::memory_order_acquire)) {}
                if (now < 0) return;
                run_share(member);
                answered[static_cast<std::size_t>(member)].value.store(cycle, std::memory_order_release);
            }
        });
    }
    Cycles controller(scale);
    for (long cycle = 1; controller.next() != Controller::stop; ++cycle) {
        opened.value.store(cycle, std::memory_order_release);
        run_share(0);
        for (int member = 1; member < members; ++member) {
            while (answered[static_cast<std::size_t>(member)].value.load(std::memory_order_acquire) < cycle) {}
        }
    }
    opened.value.store(-1, std::memory_order_release);
    return controller.turn();
}

/// One way to run M tasks per cycle; one turn after the other.
struct Contender {
    std::string name;
    int tasks;
    double task_time;  // [µs]
    std::function<Turn()> take_turn;
    std::vector<Turn> turns{};
};

Contender contender(const ExecutorRow& row, int tasks, double task_time, long length, const ExecutorOptions& options,
                    const cvtflow::bench::TickScale& scale) {
    auto graph = std::make_shared<TaskGraph>();
    for (int task = 0; task < tasks; ++task) graph->add({"t", 0, work, task, {}});
    graph->freeze();
    auto data = std::make_shared<std::vector<Work>>(static_cast<std::size_t>(tasks), Work{1.0, length});
    std::shared_ptr<Executor> executor = row.make(options);
    return {std::string(row.name), tasks, task_time, [=] {
                Cycles controller(scale);
                executor->run(*graph, data->data(), controller);
                executor->release_threads();
                return controller.turn();
            }};
}

std::vector<Contender> contenders(const Settings& settings, StampRecorder& recorder, const cvtflow::bench::TickScale& scale) {
    constexpr double long_task = 2.6, recorded_task = 5.0;
    std::vector<Contender> result;
    for (const auto& [time, length] : {std::pair{0.0, 0L}, std::pair{long_task, length_of(long_task)}}) {
        for (const int tasks : {1, 2, 4, 7, 14, 28}) {
            if (time > 0.0 && tasks != 2) continue;
            for (const ExecutorRow& row : executors()) {
                const int threads = row.parallel ? settings.threads : 1;
                result.push_back(
                    contender(row, tasks, time, length, {.threads = threads, .wait = settings.wait, .pin = settings.pin}, scale));
            }
            auto data = std::make_shared<std::vector<Work>>(static_cast<std::size_t>(tasks), Work{1.0, length});
            result.push_back({"bare spin barrier", tasks, time, [=] { return bare_barrier(*data, scale, settings); }});
        }
    }
    const ExecutorRow& serial = *find_executor("serial");
    const long length = length_of(recorded_task);
    result.push_back(contender(serial, 1, recorded_task, length, {}, scale));
    result.push_back(contender(serial, 1, recorded_task, length, {.recorder = &recorder}, scale));
    result.back().name = "serial, recorded";
    return result;
}

/// All contenders take turns, so that a noisy minute hits all alike. The first turn warms up.
void measure(std::vector<Contender>& contenders, int repetitions) {
    for (int repetition = -1; repetition < repetitions; ++repetition) {
        for (Contender& each : contenders) {
            const Turn turn = each.take_turn();
            if (repetition >= 0) each.turns.push_back(turn);
        }
    }
}

/// "model name" of the first processor.
std::string machine() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
    }
    return "unknown";
}

/// Part of the turns that took at most that long: 0.5 is the median.
double quantile(const Contender& of, double Turn::*kind, double part) {
    std::vector<double> values;
    for (const Turn& turn : of.turns) values.push_back(turn.*kind);
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

void print(const std::vector<Contender>& contenders, const Settings& settings) {
    fmt::print("oneTBB {}; OpenMP {}; {} processors, {} threads{}, wait {}, {} repetitions; [µs] per cycle\n", tbb_version(),
               cvtflow::bench::openmp_version(), usable_processors(), settings.threads, settings.pin ? ", pinned" : "", settings.wait_name,
               settings.repetitions);
    fmt::print("{:<18} {:>5} {:>5} {:>8} {:>24} {:>10} {:>10}\n", "executor", "tasks", "task", "least", "typical (quartiles)", "over ideal",
               "mean");
    for (const Contender& each : contenders) {
        const double ideal = each.name.starts_with("serial") ? each.tasks * each.task_time : each.task_time;
        const double typical = quantile(each, &Turn::typical, 0.5);
        fmt::print("{:<18} {:>5} {:>5} {:>8.2f} {:>8.2f} ({:.2f} … {:.2f}) {:>10.2f} {:>10.2f}\n", each.name, each.tasks, each.task_time,
                   quantile(each, &Turn::typical, 0.0), typical, quantile(each, &Turn::typical, 0.25), quantile(each, &Turn::typical, 0.75),
                   typical - ideal, quantile(each, &Turn::mean, 0.5));
    }
}

void write_csv(const std::vector<Contender>& contenders, const Settings& settings) {
    auto file = fmt::output_file(settings.csv);
    file.print(
        "executor,tasks,task_us,typical_us,lower_quartile_us,upper_quartile_us,least_us,mean_us,threads,pinned,wait,repetitions,machine,");
    file.print("processors,compiler,tbb,openmp,omp_wait_policy,load_average,commit,date\n");
    const Provenance here = current_provenance();
    const char* policy = std::getenv("OMP_WAIT_POLICY");
    double load = 0.0;
    const bool known = getloadavg(&load, 1) == 1;
    for (const Contender& each : contenders) {
        file.print("{},{},{}", each.name, each.tasks, each.task_time);
        for (const double part : {0.5, 0.25, 0.75, 0.0}) file.print(",{:.4f}", quantile(each, &Turn::typical, part));
        file.print(",{:.4f},{},{},{},{},\"{}\",{},\"{}\",\"{}\",{},{},{},{},{}\n", quantile(each, &Turn::mean, 0.5), settings.threads,
                   settings.pin, settings.wait_name, settings.repetitions, machine(), usable_processors(), __VERSION__, tbb_version(),
                   cvtflow::bench::openmp_version(), policy != nullptr ? policy : "", known ? fmt::format("{:.2f}", load) : "", here.commit,
                   here.date);
    }
}

Settings parse(int count, char** words) {
    Settings settings;
    for (int i = 1; i + 1 < count; i += 2) {
        const std::string key = words[i], value = words[i + 1];
        if (key == "--repetitions") settings.repetitions = std::max(1, std::stoi(value));
        if (key == "--threads") settings.threads = std::max(1, std::stoi(value));
        if (key == "--pin") settings.pin = value == "yes";
        if (key == "--csv") settings.csv = value;
        if (key == "--wait") {
            settings.wait_name = value;
            settings.wait = value == "spin" ? Wait::spin : value == "passive" ? Wait::passive : Wait::balanced;
        }
    }
    return settings;
}

}  // namespace

int main(int count, char** words) {
    cvtflow::bench::add_further_executors();
    const Settings settings = parse(count, words);
    cvtflow::bench::SpanRecorder recorder(1, 100000);
    std::vector<Contender> all = contenders(settings, recorder, cvtflow::bench::TickScale());
    measure(all, settings.repetitions);
    print(all, settings);
    if (!settings.csv.empty()) write_csv(all, settings);
}
