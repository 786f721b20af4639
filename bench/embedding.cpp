/// Jitter of advance_to() in a host's control loop: how long a call for 100 µs of the scene takes, over and over, with the host idle and with
/// k busy host threads, for each way of running. Then how long the first step of a new simulation takes, and how long after cancel() from
/// another thread a call returns. A plain program, since what counts is the distribution and not the best.
///
///     bench_embedding [--scene NAME] [--calls N] [--busy N,N,…] [--threads N]

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <cvtflow/cvtflow.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace {

struct Arguments {
    std::string scene = "tiny";
    int calls = 100;
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
    std::vector<std::jthread> threads_;   // last: they end before the rest goes
};

/// Wall times of the calls [s], ascending.
std::vector<double> measure(cvtflow::Simulation& simulation, int calls) {
    constexpr double period = 1e-4;
    const double begin = simulation.time();
    std::vector<double> times;
    for (int k = 1; k <= calls; ++k) {
        const auto started = std::chrono::steady_clock::now();
        simulation.advance_to(begin + k * period);
        times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count());
    }
    std::sort(times.begin(), times.end());
    return times;
}

[[nodiscard]] double seconds_since(std::chrono::steady_clock::time_point then) { return std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count(); }

/// Wall times from nothing to the end of the first step [s], ascending.
std::vector<double> first_steps(const cvtflow::Scene& scene, cvtflow::Threads threads, int rounds) {
    std::vector<double> times;
    for (int k = 0; k < rounds; ++k) {
        const auto begun = std::chrono::steady_clock::now();
        cvtflow::Simulation simulation(scene, threads);
        simulation.step();
        times.push_back(seconds_since(begun));
    }
    std::sort(times.begin(), times.end());
    return times;
}

/// Wall times from cancel() to the return of the call that it ends [s], ascending.
std::vector<double> cancellations(const cvtflow::Scene& scene, cvtflow::Threads threads, const cvtflow::State& start, int rounds) {
    std::vector<double> times;
    cvtflow::Simulation simulation(scene, threads);
    for (int k = 0; k < rounds; ++k) {
        simulation.set_state(start);
        std::chrono::steady_clock::time_point returned;
        std::jthread stepper([&] {
            try {
                simulation.advance_to(simulation.time() + 1e3);
            } catch (const cvtflow::Error& end) {
                returned = std::chrono::steady_clock::now();
                if (end.code() != cvtflow::ErrorCode::cancelled) fmt::print(stderr, "bench_embedding: {}\n", end.what());
            }
        });
        std::this_thread::sleep_for(std::chrono::milliseconds(3));
        const auto asked = std::chrono::steady_clock::now();
        simulation.cancel();
        stepper.join();
        times.push_back(std::chrono::duration<double>(returned - asked).count());
    }
    std::sort(times.begin(), times.end());
    return times;
}

double share(const std::vector<double>& sorted, double part) { return sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(part * static_cast<double>(sorted.size())))]; }

Arguments read(int argc, char** argv) {
    Arguments arguments;
    for (int k = 1; k + 1 < argc; k += 2) {
        const std::string option = argv[k];
        if (option == "--scene") arguments.scene = argv[k + 1];
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
    const std::pair<std::string, cvtflow::Threads> ways[] = {{"caller", cvtflow::Threads::caller()},
                                                             {fmt::format("present({})", arguments.threads), cvtflow::Threads::present(arguments.threads)},
                                                             {fmt::format("own({})", arguments.threads), cvtflow::Threads::own(arguments.threads)}};
    fmt::print("advance_to(1e-4) on {}, {} calls each, {} processors; wall time in ms; hash of the end state\n", arguments.scene, arguments.calls, std::thread::hardware_concurrency());
    fmt::print("{:>5} {:<12} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9}  {}\n", "busy", "way", "least", "median", "90 %", "99 %", "most", "99%/med.", "hash");
    for (const int busy : arguments.busy) {
        const BusyHost host(busy);
        for (const auto& [name, threads] : ways) {
            cvtflow::Simulation simulation(scene, threads);
            simulation.set_state(start);
            const std::vector<double> times = measure(simulation, arguments.calls);
            fmt::print("{:>5} {:<12} {:>8.3f} {:>8.3f} {:>8.3f} {:>8.3f} {:>8.3f} {:>9.2f}  {:016x}\n", busy, name, 1e3 * times.front(), 1e3 * share(times, 0.5),
                       1e3 * share(times, 0.9), 1e3 * share(times, 0.99), 1e3 * times.back(), share(times, 0.99) / share(times, 0.5), simulation.hash());
        }
    }
    fmt::print("\nfirst step of a new simulation, and from cancel() to the call's return; wall time in ms, {} rounds each, host idle\n", arguments.calls);
    fmt::print("{:<12} {:>12} {:>12} {:>14} {:>14}\n", "way", "first, median", "99 %", "cancel, median", "99 %");
    for (const auto& [name, threads] : ways) {
        const std::vector<double> first = first_steps(scene, threads, arguments.calls), cancelled = cancellations(scene, threads, start, arguments.calls);
        fmt::print("{:<12} {:>12.3f} {:>12.3f} {:>14.3f} {:>14.3f}\n", name, 1e3 * share(first, 0.5), 1e3 * share(first, 0.99), 1e3 * share(cancelled, 0.5), 1e3 * share(cancelled, 0.99));
    }
    return 0;
} catch (const cvtflow::Error& error) {
    fmt::print(stderr, "bench_embedding: {}\n", error.what());
    return 1;
}
