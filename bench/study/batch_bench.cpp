#include "bench/study/batch_bench.hpp"
#include "bench/study/profile/statistics.hpp"

#include <stdlib.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "tasks/batch/batch.hpp"
#include "tasks/batch/start_states.hpp"
#include "tasks/run/run.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

double cpu_seconds() {
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    const auto seconds = [](const timeval& time) { return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec); };
    return seconds(used.ru_utime) + seconds(used.ru_stime);
}

/// Wall and CPU time since it was made.
class Watch {
public:
    [[nodiscard]] double wall() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count(); }
    [[nodiscard]] double cpu() const { return cpu_seconds() - cpu_; }

private:
    std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
    double cpu_ = cpu_seconds();
};

/// An empty folder that is removed with this object, with all its files.
class OwnFolder {
public:
    /// @throws SimulationError
    OwnFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "cvtflow-batch-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) throw SimulationError(name + ": cannot create this folder");
        path_ = name;
    }
    ~OwnFolder() {
        std::error_code left;
        std::filesystem::remove_all(path_, left);
    }
    OwnFolder(const OwnFolder&) = delete;
    OwnFolder& operator=(const OwnFolder&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

private:
    std::filesystem::path path_;
};

/// All cases one after the other, nothing but their steps timed. @return evaluations
long bare_loop(const Sweep& sweep, StartStates& starts, double& wall, double& cpu) {
    const engine::Cancellation never;
    SilentObserver silent;
    std::unique_ptr<Simulation> simulation;
    Scene scene = sweep.scene;
    long evaluations = 0;
    for (long number = 0; number < sweep.cases(); ++number) {
        sweep.apply_case(number, scene);
        const StartStates::State start = starts.of_case(number, scene, never);
        Scene geometric = scene;
        geometric.state_file.clear();
        if (simulation == nullptr || !fits(*simulation, scene)) simulation = std::make_unique<Simulation>(geometric, Schedule{});
        simulation->reset(scene, start.get());
        const Watch watch;
        if (simulation->needs_settling()) {
            if (const Fault fault = simulation->advance({.until = 0.0}, silent, never)) throw StartFault(fault);
            evaluations += simulation->counters().evaluations;
        }
        (void)simulation->advance({.until = scene.run.until}, silent, never);
        evaluations += simulation->counters().evaluations;
        wall += watch.wall();
        cpu += watch.cpu();
    }
    return evaluations;
}

}  // namespace

BatchBench bench_batch(const Sweep& sweep, const std::vector<int>& threads, int rounds) {
    const OwnFolder folder;
    BatchBench bench;
    bench.cases = sweep.cases();
    std::vector<std::vector<double>> walls(threads.size() + 1), cpus(threads.size() + 1);
    StartStates starts(sweep, folder.path() / "states");
    for (int round = 0; round < rounds; ++round) {
        double wall = 0.0, cpu = 0.0;
        bench.evaluations = bare_loop(sweep, starts, wall, cpu);
        walls[0].push_back(wall);
        cpus[0].push_back(cpu);
        for (std::size_t i = 0; i < threads.size(); ++i) {
            const OwnFolder results;
            std::filesystem::copy(folder.path(), results.path(), std::filesystem::copy_options::recursive);  // settled states
            BatchOptions options;
            options.folder = results.path().string();
            options.threads = threads[i];
            const Watch watch;
            const BatchReport report = run_batch(sweep, options);
            walls[i + 1].push_back(watch.wall());
            cpus[i + 1].push_back(watch.cpu());
            if (!bench.results_hash.empty() && bench.results_hash != report.results_hash)
                throw SimulationError("results differ from run to run: " + bench.results_hash + ", " + report.results_hash);
            bench.results_hash = report.results_hash;
        }
    }
    for (std::size_t i = 0; i < walls.size(); ++i)
        bench.timings.push_back({i == 0 ? 0 : threads[i - 1], median(walls[i]), median(cpus[i])});
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    bench.peak_memory = 1024.0 * static_cast<double>(used.ru_maxrss);
    return bench;
}

std::vector<RunCost> bench_run(const Scene& scene, int rounds) {
    const OwnFolder folder;
    const engine::Cancellation never;
    const auto timed = [](const auto& run) {
        const Watch watch;
        const Fault fault = run();
        if (fault) throw SimulationError(fault.message());
        return watch.cpu();
    };
    const auto bare = [&](bool watched) {
        SilentObserver silent;
        Simulation simulation(scene, Schedule{});
        simulation.keep_energies(watched);
        Fault fault;
        if (simulation.needs_settling()) fault = simulation.advance({.until = 0.0}, silent, never);
        return fault ? fault : simulation.advance({.until = scene.run.until}, silent, never);
    };
    const auto whole = [&](const std::filesystem::path& record) {
        RunOptions options;
        if (!record.empty()) {
            std::filesystem::remove(record);
            options.file = record.string();
        }
        return run_scene(scene, options).fault;
    };
    std::vector<RunCost> costs;
    for (int round = 0; round < rounds; ++round) {
        const double unwatched = timed([&] { return bare(false); }), watched = timed([&] { return bare(true); });
        costs.push_back({unwatched, watched, timed([&] { return whole({}); }), timed([&] { return whole(folder.path() / "run.h5"); })});
    }
    return costs;
}

}  // namespace cvtflow::bench
