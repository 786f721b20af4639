/// Solvers of others beside our methods, on the same right-hand side, over the same stretch, with errors by the same comparison: seconds
/// per simulated second against error. Phases of tips are ours to change, so the stretch ends before the first transition: the peers have
/// no events to locate, and begin only once.
///
/// Committed figures come from `bench_peers baseline -o bench/results` on a quiet machine.
///
///     bench_peers [SCENE] [--time US] [--interval US] [--rounds N] [--tolerances LIST] [--methods METHOD@US,…] [--agree ERROR] [-o DIR]

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <sstream>
#include <stdexcept>

#include "bench/lab/show.hpp"
#include "bench/peers/solvers.hpp"
#include "bench/study/error_measure.hpp"
#include "bench/study/profile/other_load.hpp"
#include "bench/study/profile/statistics.hpp"
#include "bench/study/run_watch.hpp"
#include "engine/executor/cancellation.hpp"
#include "tasks/run/simulation.hpp"
#include "tools/program/guard.hpp"

namespace {

using namespace cvtflow;

struct Candidate {
    std::string method;
    double step;  ///< [s]

    [[nodiscard]] std::vector<std::string> settings() const { return {"run.method=" + method, fmt::format("run.step={:.17g}", step)}; }
};

struct Settings {
    std::string scene = "baseline", folder;
    double time = 120e-6, interval = 6e-6;  ///< [s]
    int rounds = 3;
    double agreement = 0.0;  ///< the smallest error of tensions that every solver has to come down to; 0: any [1]
    std::vector<double> tolerances{1e-2, 1e-3, 1e-4, 1e-5, 1e-6};
    std::vector<Candidate> methods{{"rk4", 50e-9},      {"rk4", 25e-9},           {"dumka3-p5", 3e-6},     {"dumka3-p5", 2e-6},
                                   {"dumka3-p5", 1e-6}, {"leapfrog-sweep", 2e-6}, {"leapfrog-sweep", 1e-6}};
};

/// One solver with one step or tolerance.
struct Row {
    std::string solver, choice, fault;
    double cost = 0.0;  ///< seconds per simulated second
    double error_axial = 0.0, error_tension = 0.0;
    long steps = 0, evaluations = 0, jacobians = 0;
};

std::vector<std::string> parts_of(const std::string& list) {
    std::vector<std::string> parts;
    std::stringstream stream(list);
    for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
    return parts;
}

Candidate candidate_of(const std::string& word) {
    const std::size_t at = word.find('@');
    if (at == std::string::npos) throw std::invalid_argument("--methods: METHOD@US, not '" + word + "'");
    return {word.substr(0, at), 1e-6 * std::stod(word.substr(at + 1))};
}

Settings parse(int count, char** words) {
    Settings settings;
    int i = 1;
    if (i < count && words[i][0] != '-') settings.scene = words[i++];
    for (; i < count; i += 2) {
        const std::string key = words[i];
        if (i + 1 == count) throw std::invalid_argument(key + " wants a value");
        const std::string value = words[i + 1];
        if (key == "--time")
            settings.time = 1e-6 * std::stod(value);
        else if (key == "--interval")
            settings.interval = 1e-6 * std::stod(value);
        else if (key == "--rounds")
            settings.rounds = std::max(1, std::stoi(value));
        else if (key == "--agree")
            settings.agreement = std::stod(value);
        else if (key == "-o")
            settings.folder = value;
        else if (key == "--tolerances") {
            settings.tolerances.clear();
            for (const std::string& part : parts_of(value)) settings.tolerances.push_back(std::stod(part));
        } else if (key == "--methods") {
            settings.methods.clear();
            for (const std::string& part : parts_of(value)) settings.methods.push_back(candidate_of(part));
        } else
            throw std::invalid_argument("there is no option " + key);
    }
    return settings;
}

/// Measure of our methods. duration [s], reference: settings
bench::ErrorMeasure measure_over(double duration, const tasks::Scene& scene, const engine::SavedState& start, const Settings& settings,
                                 const Candidate& reference) {
    static const engine::Cancellation never;
    bench::MeasureSettings measure{duration, settings.interval, reference.settings()};
    measure.start = start;
    return {scene, measure, never};
}

/// The longest time, a multiple of the interval, before any tip changes its phase [s].
double quiet_stretch(const tasks::Scene& scene, const engine::SavedState& start, const Settings& settings) {
    const bench::Trajectory run = measure_over(settings.time, scene, start, settings, {"rk4", 25e-9}).reference();
    if (run.transitions.empty()) return settings.time;
    return std::floor(run.transitions.front().time / settings.interval) * settings.interval;
}

std::vector<Row> our_rows(const bench::ErrorMeasure& measure, const Settings& settings) {
    std::vector<Row> rows;
    std::vector<std::vector<double>> seconds(settings.methods.size());
    for (int round = 0; round < settings.rounds; ++round) {
        rows.clear();
        for (std::size_t k = 0; k < settings.methods.size(); ++k) {
            const bench::Trajectory run = measure.run(settings.methods[k].settings());
            const bench::TrajectoryErrors errors = measure.errors(run).overall;
            seconds[k].push_back(run.wall_per_second());
            rows.push_back({settings.methods[k].method, fmt::format("{:.4g} us", 1e6 * run.step), run.fault ? run.fault.message() : "",
                            bench::median(seconds[k]), errors.axial_force, errors.tension, run.counters.steps, run.counters.evaluations,
                            0});
        }
    }
    return rows;
}

double error_of(const std::vector<std::vector<double>>& is, const std::vector<std::vector<double>>& should) {
    bench::RelativeError error;
    for (std::size_t row = 0; row < should.size(); ++row) error.add(is[row], should[row]);
    return error.value();
}

Row peer_row(const bench::Peer& peer, bench::Problem& problem, double tolerance, const bench::Trajectory& reference,
             const Settings& settings, double duration) {
    std::vector<double> seconds;
    bench::PeerRun run;
    for (int round = 0; round < settings.rounds && run.fault.empty(); ++round) {
        run = peer.run(problem, tolerance);
        seconds.push_back(run.seconds);
    }
    Row row{
        peer.name,    fmt::format("{:g}", tolerance), run.fault, bench::median(seconds) / duration, NAN, NAN, run.steps, run.evaluations,
        run.jacobians};
    if (!run.fault.empty()) return row;
    row.error_axial = error_of(run.trajectory.axial_force, reference.axial_force);
    row.error_tension = error_of(run.trajectory.tension, reference.tension);
    return row;
}

/// Rows of the table.
bench::Json rows_json(const std::vector<Row>& rows, const Settings& settings, double duration, double got) {
    bench::Json list = bench::Json::array();
    for (const Row& row : rows)
        list.push_back(bench::named(
            "scene,duration_us,solver,choice,steps,evaluations,jacobians,seconds_per_simulated_second,error_axial,error_tension,fault,"
            "rounds,calibrated,sundials",
            {settings.scene, 1e6 * duration, row.solver, row.choice, row.steps, row.evaluations, row.jacobians, row.cost,
             bench::number_json(row.error_axial), bench::number_json(row.error_tension), row.fault, settings.rounds, got,
             bench::sundials_version()}));
    return list;
}

/// Every solver has to come down to the agreement with one of its choices. @return a line for each that does not
bench::Json complaints_of(const std::vector<Row>& rows, double agreement) {
    std::map<std::string, double> least;
    for (const Row& row : rows) {
        const auto [entry, fresh] = least.try_emplace(row.solver, row.error_tension);
        if (!fresh && !(entry->second <= row.error_tension)) entry->second = row.error_tension;
    }
    bench::Json complaints = bench::Json::array();
    for (const auto& [solver, error] : least) {
        if (agreement == 0.0 || error <= agreement) continue;
        complaints.push_back(fmt::format("{} comes down to {:.2e}, not to {:.2e}", solver, error, agreement));
    }
    return complaints;
}

[[noreturn]] void run(const Settings& settings) {
    tasks::Scene scene = tasks::read_scene(std::filesystem::path(CVTFLOW_SOURCE_DIR "/scenes") / (settings.scene + ".toml"));
    tasks::set_value(scene, "run.schedule=serial");
    tasks::Simulation simulation(scene);
    tasks::SilentObserver silent;
    const engine::Cancellation never;
    if (simulation.needs_settling() && simulation.advance({.until = 0.0}, silent, never))
        throw std::runtime_error("the start does not settle");
    const engine::SavedState saved = simulation.saved_state();
    const double duration = quiet_stretch(scene, saved, settings);
    if (duration < settings.interval) throw std::runtime_error("a tip changes its phase within the first interval: take a shorter one");
    double got = bench::processors_got(1, 0.1);
    const bench::ErrorMeasure measure = measure_over(duration, scene, saved, settings, {"rk4", 12.5e-9});
    std::vector<Row> rows = our_rows(measure, settings);
    bench::Problem problem(scene, bench::frozen_start(simulation), duration, settings.interval);
    for (const bench::Peer& peer : bench::peers()) {
        for (const double tolerance : settings.tolerances)
            rows.push_back(peer_row(peer, problem, tolerance, measure.reference(), settings, duration));
    }
    got = std::min(got, bench::processors_got(1, 0.1));
    bench::Json solvers = bench::Json::array();
    for (const bench::Peer& peer : bench::peers()) solvers.push_back(bench::Json::array({peer.name, peer.description}));
    bench::show("peers",
                {{"rows", rows_json(rows, settings, duration, got)},
                 {"size", problem.size()},
                 {"peers", std::move(solvers)},
                 {"machine", bench::machine_json()},
                 {"complaints", complaints_of(rows, settings.agreement)}},
                {.folder = settings.folder});
}

}  // namespace

int main(int count, char** words) try {
    cvtflow::tools::name_program("bench_peers");
    run(parse(count, words));
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_peers: %s\n", error.what());
    return 1;
}
