/// What the synchronisation of one cycle costs: every executor on empty tasks, and on two tasks of 2.6 µs, the cost above the ideal.
/// Beside them a hand-made barrier of two spinning threads, the least that is possible; and what time stamps cost on a task of 5 µs. A plain program, because executors must
/// alternate within one process and medians be taken over repetitions: on a machine with neighbours nothing else can be compared.
///
///     bench_synchronisation [--repetitions N] [--threads N] [--wait spin|balanced|passive] [--csv FILE]

#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "engine/executor/catalogue.hpp"
#include "engine/executor/runtimes.hpp"
#include "engine/executor/stamp_recorder.hpp"

namespace {

using namespace cvtflow::engine;

struct Settings {
    int repetitions = 15;
    int threads = 2;
    Wait wait = Wait::balanced;
    std::string wait_name = "balanced";
    std::string csv;
};

/// Numbers of one cell: [µs per cycle].
struct Cell {
    double least, lower_quartile, median, upper_quartile;
};

/// Arithmetic that depends on itself, so that its time is its length; each task has a line of its own.
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

/// That many cycles, and their time without the first fifth: when a run begins, threads are still on their way.
class Cycles final : public Controller {
public:
    explicit Cycles(long count) : left_(count), timed_(std::max(1L, count * 4 / 5)) {}
    int next() noexcept override {
        if (left_ == timed_) begin_ = std::chrono::steady_clock::now();
        if (left_ == 0) end_ = std::chrono::steady_clock::now();
        return left_-- > 0 ? 0 : stop;
    }
    /// [µs]
    [[nodiscard]] double per_cycle() const {
        return std::chrono::duration<double, std::micro>(end_ - begin_).count() / static_cast<double>(timed_);
    }

private:
    long left_, timed_;
    std::chrono::steady_clock::time_point begin_, end_;
};

double microseconds(const std::function<void()>& action) {
    const auto begin = std::chrono::steady_clock::now();
    action();
    return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
}

/// Iterations of `work` that take that long on a quiet processor: the least of many tries.
long length_of(double wanted) {
    Work probe{1.0, 20000};
    double least = 1e9;
    for (int i = 0; i < 200; ++i) least = std::min(least, microseconds([&] { work(&probe, 0); }));
    return static_cast<long>(wanted / least * static_cast<double>(probe.length));
}

/// Two threads, two tasks, one counter each: opened by one, answered by the other.
double bare_barrier(std::vector<Work>& data, long cycles) {
    alignas(128) std::atomic<long> opened{0};
    alignas(128) std::atomic<long> answered{0};
    std::jthread other([&] {
        for (long cycle = 1; cycle <= cycles; ++cycle) {
            while (opened.load(std::memory_order_acquire) < cycle) {}
            work(data.data(), 1);
            answered.store(cycle, std::memory_order_release);
        }
    });
    Cycles controller(cycles);
    for (long cycle = 1; controller.next() != Controller::stop; ++cycle) {
        opened.store(cycle, std::memory_order_release);
        work(data.data(), 0);
        while (answered.load(std::memory_order_acquire) < cycle) {}
    }
    return controller.per_cycle();
}

/// One way to run M tasks per cycle; takes the number of cycles, returns [µs] per cycle.
struct Contender {
    std::string name;
    int tasks;
    double task_time;  // [µs]
    std::function<double(long)> run;
    std::vector<double> per_cycle{};
};

Contender contender(const ExecutorRow& row, int tasks, double task_time, long length, const ExecutorOptions& options) {
    auto graph = std::make_shared<TaskGraph>();
    for (int task = 0; task < tasks; ++task) graph->add({"t", 0, work, task, {}});
    graph->freeze();
    auto data = std::make_shared<std::vector<Work>>(static_cast<std::size_t>(tasks), Work{1.0, length});
    std::shared_ptr<Executor> executor = row.make(options);
    return {std::string(row.name), tasks, task_time, [=](long cycles) {
                Cycles controller(cycles);
                executor->run(*graph, data->data(), controller);
                return controller.per_cycle();
            }};
}

std::vector<Contender> contenders(const Settings& settings, StampRecorder& recorder) {
    constexpr double long_task = 2.6, recorded_task = 5.0;
    std::vector<Contender> result;
    for (const auto& [time, length] : {std::pair{0.0, 0L}, std::pair{long_task, length_of(long_task)}}) {
        for (const int tasks : {1, 2, 4, 7, 14, 28}) {
            if (time > 0.0 && tasks != 2) continue;
            for (const ExecutorRow& row : executors()) {
                const int threads = row.parallel ? settings.threads : 1;
                result.push_back(contender(row, tasks, time, length, {.threads = threads, .wait = settings.wait}));
            }
            if (tasks != 2) continue;
            auto data = std::make_shared<std::vector<Work>>(2, Work{1.0, length});
            result.push_back({"bare spin barrier", tasks, time, [=](long cycles) { return bare_barrier(*data, cycles); }});
        }
    }
    const ExecutorRow& serial = *find_executor("serial");
    const long length = length_of(recorded_task);
    result.push_back(contender(serial, 1, recorded_task, length, {}));
    result.push_back(contender(serial, 1, recorded_task, length, {.recorder = &recorder}));
    result.back().name = "serial, recorded";
    return result;
}

/// All contenders take turns, so that a noisy minute hits all alike. Cycles per turn: about 20 ms.
void measure(std::vector<Contender>& contenders, int repetitions) {
    for (int repetition = -1; repetition < repetitions; ++repetition) {
        for (Contender& each : contenders) {
            const double before = each.per_cycle.empty() ? each.run(200) : each.per_cycle.back();
            const long cycles = std::clamp(static_cast<long>(20000.0 / before), 100L, 100000L);
            const double time = each.run(cycles);
            if (repetition >= 0) each.per_cycle.push_back(time);  // the first turn warms up
        }
    }
}

Cell cell(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const auto at = [&](double part) { return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))]; };
    return {at(0.0), at(0.25), at(0.5), at(0.75)};
}

void print(const std::vector<Contender>& contenders, const Settings& settings) {
    fmt::print("oneTBB {}; OpenMP {}; {} processors, {} threads, wait {}, {} repetitions\n", tbb_version(), openmp_version(),
               usable_processors(), settings.threads, settings.wait_name, settings.repetitions);
    fmt::print("{:<18} {:>5} {:>9} {:>8} {:>24} {:>10}\n", "executor", "tasks", "task [µs]", "least", "median (quartiles) [µs]",
               "above the ideal");
    for (const Contender& each : contenders) {
        const Cell c = cell(each.per_cycle);
        const double ideal = each.name.starts_with("serial") ? each.tasks * each.task_time : each.task_time;
        fmt::print("{:<18} {:>5} {:>9} {:>8.2f} {:>8.2f} ({:.2f} … {:.2f}) {:>10.2f}\n", each.name, each.tasks, each.task_time, c.least,
                   c.median, c.lower_quartile, c.upper_quartile, c.median - ideal);
    }
}

void write_csv(const std::vector<Contender>& contenders, const Settings& settings) {
    auto file = fmt::output_file(settings.csv);
    file.print(
        "executor,tasks,task_us,least_us,median_us,lower_quartile_us,upper_quartile_us,threads,wait,repetitions,processors,compiler,tbb,"
        "openmp\n");
    for (const Contender& each : contenders) {
        const Cell c = cell(each.per_cycle);
        file.print("{},{},{},{:.4f},{:.4f},{:.4f},{:.4f},{},{},{},{},\"{}\",\"{}\",{}\n", each.name, each.tasks, each.task_time, c.least,
                   c.median, c.lower_quartile, c.upper_quartile, settings.threads, settings.wait_name, settings.repetitions,
                   usable_processors(), __VERSION__, tbb_version(), openmp_version());
    }
}

Settings parse(int count, char** words) {
    Settings settings;
    for (int i = 1; i + 1 < count; i += 2) {
        const std::string key = words[i], value = words[i + 1];
        if (key == "--repetitions") settings.repetitions = std::max(1, std::stoi(value));
        if (key == "--threads") settings.threads = std::max(1, std::stoi(value));
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
    const Settings settings = parse(count, words);
    StampRecorder recorder(1, 100000);
    std::vector<Contender> all = contenders(settings, recorder);
    measure(all, settings.repetitions);
    print(all, settings);
    if (!settings.csv.empty()) write_csv(all, settings);
}
