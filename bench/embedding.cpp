/// Jitter of advance_to() in a host's control loop: how long a call for 100 µs of the scene takes, over and over, with the host idle and
/// with k busy host threads, for each way of running. Then how long the first step of a new simulation takes, and how long after cancel()
/// from another thread a call returns, host idle. A plain program, since what counts is the distribution and not the best. The column
/// "others" is the number of processors that other processes took meanwhile (a quiet machine: less than 0.05); if it is larger, other
/// processes disturbed the times. Committed figures come from `bench_embedding --csv FILE` on a quiet machine.
///
///     bench_embedding [--scene NAME] [--calls N] [--busy N,N,…] [--threads N] [--csv FILE]

#include <fmt/format.h>
#include <fmt/os.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <cvtflow/cvtflow.hpp>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "bench/study/compiler_flags.hpp"
#include "engine/base/provenance.hpp"
#include "engine/thread/worker_threads.hpp"

namespace {

struct Arguments {
    std::string scene = "tiny";
    std::string csv;
    int calls = 200;
    int threads = 2;
    std::vector<int> busy{0, 1, 2, 4};
};

/// Threads of the host that do something else all the time.
class BusyHost {
public:
    explicit BusyHost(int count) {
        for (int k = 0; k < count; ++k) {
            threads_.emplace_back([this] {
                double x = 0.5;
                while (!stop_.load(std::memory_order_relaxed)) x = std::sin(x) + 1e-3;
                sink_.store(x, std::memory_order_relaxed);
            });
        }
    }
    ~BusyHost() { stop_ = true; }
    BusyHost(const BusyHost&) = delete;
    BusyHost& operator=(const BusyHost&) = delete;

private:
    std::atomic<bool> stop_{false};
    std::atomic<double> sink_{0.0};
    std::vector<std::jthread> threads_;  // last: they end before the rest goes
};

using Clock = std::chrono::steady_clock;
[[nodiscard]] double seconds(Clock::duration time) { return std::chrono::duration<double>(time).count(); }

/// Processor time of all processes but this one since the start of the machine [s]; zero where the system does not report it.
double time_of_others() {
    std::ifstream file("/proc/stat");
    std::string name;
    double user = 0.0, nice = 0.0, system = 0.0;
    if (!(file >> name >> user >> nice >> system)) return 0.0;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto of = [](const timeval& time) { return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec); };
    return (user + nice + system) / static_cast<double>(sysconf(_SC_CLK_TCK)) - of(usage.ru_utime) - of(usage.ru_stime);
}

struct Way {
    std::string name;
    cvtflow::Threads threads;
};

/// Measurements of one way of running.
struct Row {
    const char* quantity;
    int busy = 0;
    std::string way;
    std::vector<double> times{};  ///< [s], ascending
    double others = 0.0;          ///< processors that other processes took meanwhile
    std::uint64_t hash = 0;

    /// The part-quantile [s].
    [[nodiscard]] double at(double part) const {
        return times[std::min(times.size() - 1, static_cast<std::size_t>(part * static_cast<double>(times.size())))];
    }
};

/// Fills `times` with the results of `one`, `rounds` times over, and `others`.
template <class One>
Row measured(const char* quantity, int busy, const std::string& way, int rounds, const One& one) {
    Row row{quantity, busy, way};
    const double others = time_of_others();
    const Clock::time_point begun = Clock::now();
    for (int round = 0; round < rounds; ++round) row.times.push_back(one());
    row.others = std::max(0.0, (time_of_others() - others) / seconds(Clock::now() - begun));
    std::sort(row.times.begin(), row.times.end());
    return row;
}

/// Calls for 100 µs of the scene, one after the other.
Row jitter(const cvtflow::Scene& scene, const cvtflow::State& start, const Way& way, int busy, int calls) {
    cvtflow::Simulation simulation(scene, way.threads);
    simulation.set_state(start);
    const double begin = simulation.time();
    int call = 0;
    Row row = measured("advance_100us", busy, way.name, calls, [&] {
        const Clock::time_point begun = Clock::now();
        simulation.advance_to(begin + 1e-4 * ++call);
        return seconds(Clock::now() - begun);
    });
    row.hash = simulation.hash();
    return row;
}

/// Time from a scene to the end of a new simulation's first step.
Row first_step(const cvtflow::Scene& scene, const Way& way, int rounds) {
    return measured("first_step", 0, way.name, rounds, [&] {
        const Clock::time_point begun = Clock::now();
        cvtflow::Simulation simulation(scene, way.threads);
        simulation.step();
        return seconds(Clock::now() - begun);
    });
}

/// Time from cancel() to the return of the call that it ends.
Row cancellation(const cvtflow::Scene& scene, const cvtflow::State& start, const Way& way, int rounds) {
    cvtflow::Simulation simulation(scene, way.threads);
    return measured("cancellation", 0, way.name, rounds, [&] {
        simulation.set_state(start);
        Clock::time_point returned;
        std::jthread stepper([&] {
            try {
                simulation.advance_to(simulation.time() + 1e3);
            } catch (const cvtflow::Error& end) {
                returned = Clock::now();
                if (end.code() != cvtflow::ErrorCode::cancelled) fmt::print(stderr, "bench_embedding: {}\n", end.what());
            }
        });
        std::this_thread::sleep_for(std::chrono::milliseconds(3));
        const Clock::time_point asked = Clock::now();
        simulation.cancel();
        stepper.join();
        return seconds(returned - asked);
    });
}

void print_head() {
    fmt::print("{:<14} {:>5} {:<12} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9} {:>7}  {}\n", "wall time, ms", "busy", "way", "least", "median",
               "90 %", "99 %", "most", "99%/med.", "others", "hash of the end state");
}

const Row& print(const Row& row) {
    fmt::print("{:<14} {:>5} {:<12} {:>8.3f} {:>8.3f} {:>8.3f} {:>8.3f} {:>8.3f} {:>9.2f} {:>7.2f}  {}\n", row.quantity, row.busy, row.way,
               1e3 * row.times.front(), 1e3 * row.at(0.5), 1e3 * row.at(0.9), 1e3 * row.at(0.99), 1e3 * row.times.back(),
               row.at(0.99) / row.at(0.5), row.others, row.hash != 0 ? fmt::format("{:016x}", row.hash) : "");
    std::fflush(stdout);
    return row;
}

void write_csv(const std::vector<Row>& rows, const Arguments& arguments) {
    auto file = fmt::output_file(arguments.csv);
    const cvtflow::engine::Provenance here = cvtflow::engine::current_provenance();
    file.print(
        "quantity,scene,busy,way,rounds,min_ms,median_ms,p90_ms,p99_ms,max_ms,others,hash,commit,compiler,flags,tbb,cpu,cores,date\n");
    for (const Row& row : rows) {
        file.print("{},{},{},{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.3f},{:016x},\"{}\",\"{} {}\",\"{}\",\"{}\",\"{}\",{},\"{}\"\n",
                   row.quantity, arguments.scene, row.busy, row.way, row.times.size(), 1e3 * row.times.front(), 1e3 * row.at(0.5),
                   1e3 * row.at(0.9), 1e3 * row.at(0.99), 1e3 * row.times.back(), row.others, row.hash, here.commit, here.compiler,
                   here.build_type, cvtflow::bench::compiler_flags(), cvtflow::engine::tbb_version(), here.cpu, here.cores, here.date);
    }
}

Arguments read(int argc, char** argv) {
    Arguments arguments;
    for (int k = 1; k + 1 < argc; k += 2) {
        const std::string option = argv[k];
        if (option == "--scene") arguments.scene = argv[k + 1];
        if (option == "--csv") arguments.csv = argv[k + 1];
        if (option == "--calls") arguments.calls = std::max(1, std::atoi(argv[k + 1]));
        if (option == "--threads") arguments.threads = std::max(1, std::atoi(argv[k + 1]));
        if (option != "--busy") continue;
        arguments.busy.clear();
        std::istringstream list(argv[k + 1]);
        for (std::string number; std::getline(list, number, ',');) arguments.busy.push_back(std::atoi(number.c_str()));
    }
    return arguments;
}

}  // namespace

int main(int argc, char** argv) try {
    const Arguments arguments = read(argc, argv);
    const std::vector<std::string> settings{"run.method=dumka3-p5", "run.step=1 us"};
    const cvtflow::Scene scene = cvtflow::Scene::ready(arguments.scene).with(settings);
    cvtflow::Simulation settled(scene);
    settled.advance_to(0.0);
    const cvtflow::State start = settled.state();
    const Way ways[] = {{"caller", cvtflow::Threads::caller()},
                        {fmt::format("present({})", arguments.threads), cvtflow::Threads::current_arena(arguments.threads)},
                        {fmt::format("own({})", arguments.threads), cvtflow::Threads::private_arena(arguments.threads)}};
    fmt::print(
        "advance_to(1e-4) on {}, beside busy threads of the host; first steps and cancellations with the host idle; {} rounds "
        "each, {} processors\n",
        arguments.scene, arguments.calls, std::thread::hardware_concurrency());
    print_head();
    std::vector<Row> rows;
    for (const int busy : arguments.busy) {
        const BusyHost host(busy);
        for (const Way& way : ways) rows.push_back(print(jitter(scene, start, way, busy, arguments.calls)));
    }
    for (const Way& way : ways) rows.push_back(print(first_step(scene, way, arguments.calls)));
    for (const Way& way : ways) rows.push_back(print(cancellation(scene, start, way, arguments.calls)));
    if (!arguments.csv.empty()) write_csv(rows, arguments);
    return 0;
} catch (const cvtflow::Error& error) {
    fmt::print(stderr, "bench_embedding: {}\n", error.what());
    return 1;
}
