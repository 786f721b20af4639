#include "tasks/schedule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "engine/executor/catalogue.hpp"
#include "engine/executor/runtimes.hpp"

namespace cvtflow::tasks {

namespace {

/// Whole processors of a cgroup's CPU quota ("max 100000" or "quota period" in cpu.max), or a large number.
[[nodiscard]] int quota_processors() {
    std::ifstream file("/sys/fs/cgroup/cpu.max");
    std::string quota;
    double period = 0.0;
    if (!(file >> quota >> period) || quota == "max" || period <= 0.0) return std::numeric_limits<int>::max();
    return std::max(1, static_cast<int>(std::strtod(quota.c_str(), nullptr) / period));
}

/// What a batch system granted to this task, or a large number.
[[nodiscard]] int granted_processors() {
    const char* granted = std::getenv("SLURM_CPUS_PER_TASK");
    const int number = granted != nullptr ? std::atoi(granted) : 0;
    return number > 0 ? number : std::numeric_limits<int>::max();
}

}  // namespace

int usable_threads() { return std::max(1, std::min({engine::usable_processors(), quota_processors(), granted_processors()})); }

namespace {

const std::pair<const char*, AssemblyOptions> assemblies[] = {
    {"fused", {Assembly::fused, true, true}},
    {"staged", {Assembly::staged, true, true}},
    {"staged-serial-cholesky", {Assembly::staged, false, true}},
    {"staged-serial-transition", {Assembly::staged, true, false}},
    {"staged-serial-both", {Assembly::staged, false, false}},
};

}  // namespace

std::string assembly_name(const AssemblyOptions& assembly) {
    const auto row = std::find_if(std::begin(assemblies), std::end(assemblies), [&](const auto& each) { return each.second == assembly; });
    return row != std::end(assemblies) ? row->first : "fused";
}

AssemblyOptions assembly_named(const std::string& name) {
    std::string names;
    for (const auto& [known, options] : assemblies) {
        if (name == known) return options;
        names += (names.empty() ? "" : ", ") + std::string(known);
    }
    throw SceneError(fmt::format("'{}' is no assembly: {}", name, names));
}

std::string Schedule::text() const {
    if (executor == "serial" && segments == 1 && assembly.kind == Assembly::fused) return "serial";
    return fmt::format("{}, {}, {} segments, {} threads", executor, assembly_name(assembly), segments, threads);
}

Schedule schedule_of(const RunSettings& run, int links) {
    Schedule schedule;
    schedule.threads = run.threads > 0 ? run.threads : usable_threads();
    schedule.segments = run.segments > 0 ? run.segments : std::min(schedule.threads, links);
    schedule.assembly.kind = run.assembly;
    schedule.balanced = run.partition == PartitionKind::balanced;
    if (run.schedule == "auto") return schedule;
    if (engine::find_executor(run.schedule) == nullptr) {
        throw SceneError(fmt::format("run.schedule: there is no executor '{}' (cvtflow list executors; or auto)", run.schedule));
    }
    schedule.executor = run.schedule;
    if (run.schedule == "serial") {
        schedule.threads = 1;
        if (run.segments == 0) schedule.segments = 1;
    }
    return schedule;
}

std::unique_ptr<engine::Executor> make_executor(const Schedule& schedule, engine::StampRecorder* recorder) {
    const engine::ExecutorRow* row = engine::find_executor(schedule.executor);
    if (row == nullptr) throw SceneError(fmt::format("run.schedule: there is no executor '{}'", schedule.executor));
    engine::ExecutorOptions options;
    options.threads = schedule.threads;
    options.wait = schedule.wait;
    options.pin = schedule.pin;
    options.present_arena = schedule.present_arena;
    options.recorder = recorder;
    return row->make(options);
}

Partition balanced_partition(const std::vector<model::Phase>& phases, int links, int segments, const LinkCosts& costs) {
    std::vector<double> until{0.0};   // cost of the links before
    for (int link = 0; link < links; ++link) {
        const auto tips = phases.begin() + model::tips_per_link * link;
        const bool touching = std::any_of(tips, tips + model::tips_per_link, [](model::Phase phase) { return phase != model::Phase::free; });
        until.push_back(until.back() + (touching ? costs.touching : costs.free));
    }
    std::vector<int> cuts{0};
    for (int s = 1; s < segments; ++s) {
        const double wanted = until.back() * s / segments;
        const auto above = std::lower_bound(until.begin(), until.end(), wanted);
        const auto nearest = above != until.begin() && wanted - *(above - 1) < *above - wanted ? above - 1 : above;
        cuts.push_back(std::clamp(static_cast<int>(nearest - until.begin()), cuts.back() + 1, links - (segments - s)));
    }
    cuts.push_back(links);
    return Partition::at(cuts);
}

}  // namespace cvtflow::tasks
