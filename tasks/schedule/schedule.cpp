#include "tasks/schedule/schedule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "engine/base/provenance.hpp"
#include "engine/base/text.hpp"
#include "engine/executor/catalogue.hpp"

namespace cvtflow::tasks {

namespace {

/// Least quota of the group and all that it lies in ("max 100000" or "quota period" in cpu.max), whole processors; a large number: none.
[[nodiscard]] int min_quota(const std::filesystem::path& root, std::filesystem::path group) {
    int least = std::numeric_limits<int>::max();
    for (group = group.relative_path();; group = group.parent_path()) {
        std::ifstream file(root / group / "cpu.max");
        std::string quota, period;
        file >> quota >> period;
        const auto granted = engine::number_of(quota), of = engine::number_of(period);  // none: "max"
        if (granted && of && *of > 0.0) least = std::min(least, std::max(1, static_cast<int>(*granted / *of)));
        if (group.empty()) return least;
    }
}

/// Number of processors that a batch system granted to this task, or a large number.
[[nodiscard]] int granted_processors() {
    const char* granted = std::getenv("SLURM_CPUS_PER_TASK");
    const int number = granted != nullptr ? std::atoi(granted) : 0;
    return number > 0 ? number : std::numeric_limits<int>::max();
}

}  // namespace

int quota_processors(const std::filesystem::path& root, const std::filesystem::path& membership) {
    std::ifstream file(membership);
    std::filesystem::path group;
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("0::")) group = line.substr(3);
    }
    return min_quota(root, group);
}

int usable_threads() {
    return std::max(1,
                    std::min({engine::usable_processors(), quota_processors("/sys/fs/cgroup", "/proc/self/cgroup"), granted_processors()}));
}

namespace {

const NamedAssembly named_assemblies[] = {
    {"fused", {Assembly::fused, true, true}},
    {"staged", {Assembly::staged, true, true}},
    {"staged-serial-cholesky", {Assembly::staged, false, true}},
    {"staged-serial-transition", {Assembly::staged, true, false}},
    {"staged-serial-both", {Assembly::staged, false, false}},
};

}  // namespace

std::span<const NamedAssembly> assemblies() noexcept { return named_assemblies; }

std::string assembly_name(const AssemblyOptions& assembly) {
    const auto row = std::ranges::find(named_assemblies, assembly, &NamedAssembly::second);
    return row != std::end(named_assemblies) ? row->first : "fused";
}

std::string Schedule::text() const {
    if (executor == "serial" && segments == 1 && assembly.kind == Assembly::fused) return "serial";
    return fmt::format("{}, {}, {} segments, {} threads{}", executor, assembly_name(assembly), segments, threads,
                       balanced ? ", balanced" : "");
}

Schedule schedule_of(const RunSettings& run, int links) {
    Schedule schedule;
    schedule.threads = run.threads > 0 ? run.threads : usable_threads();
    schedule.segments = run.segments > 0 ? run.segments : std::min(schedule.threads, links);
    schedule.assembly.kind = run.assembly;
    schedule.balanced = run.partition == PartitionKind::balanced;
    if (run.schedule == "auto") return schedule;
    if (engine::find_executor(run.schedule) == nullptr) {
        throw SceneError(fmt::format("run.schedule: unknown executor '{}'{} (cvtflow list executors; or auto)", run.schedule,
                                     engine::missing_executor(run.schedule)));
    }
    schedule.executor = run.schedule;
    if (run.schedule == "serial") {
        schedule.threads = 1;
        if (run.segments == 0) schedule.segments = 1;
    }
    return schedule;
}

int max_segments(const model::Parameters& parameters) noexcept {
    return parameters.detail.pins == model::PinDetail::rigid ? 1 : parameters.chain.pins;
}

std::vector<Schedule> schedules_for(const Scene& scene) {
    const int links = max_segments(scene.parameters);
    Schedule serial = schedule_of(scene.run, links);
    if (scene.run.schedule != "auto") return {serial};
    Schedule flow = serial;
    flow.executor = "flow";
    flow.threads = std::min(serial.threads, links);
    serial.executor = "serial";
    serial.threads = 1;
    serial.balanced = false;
    if (scene.run.segments == 0) serial.segments = 1;
    std::vector<Schedule> list{serial};
    for (; flow.threads >= 2; flow.threads /= 2) {
        if (scene.run.segments == 0) flow.segments = flow.threads;
        list.insert(list.begin() + 1, flow);
    }
    return list;
}

std::unique_ptr<engine::Executor> make_executor(const Schedule& schedule, engine::StampRecorder* recorder) {
    const engine::ExecutorRow* row = engine::find_executor(schedule.executor);
    if (row == nullptr) throw SceneError(fmt::format("run.schedule: unknown executor '{}'", schedule.executor));
    return row->make({.threads = schedule.threads,
                      .wait = schedule.wait,
                      .pin = schedule.pin,
                      .present_arena = schedule.present_arena,
                      .recorder = recorder});
}

namespace {

/// Links that are evaluated side by side cost what the most expensive of them does, however few they are.
[[nodiscard]] double unit_cost(const std::vector<model::Phase>& phases, int first, int last, const LinkCosts& costs) noexcept {
    for (int link = first; link < last; ++link) {
        if (model::touches(phases.data(), link)) return costs.grain * costs.touching;
    }
    return costs.grain * costs.free;
}

}  // namespace

double longest_segment(const std::vector<model::Phase>& phases, std::span<const int> cuts, const LinkCosts& costs) noexcept {
    double longest = 0.0;
    for (std::size_t s = 1; s < cuts.size(); ++s) {
        double cost = 0.0;
        for (int link = cuts[s - 1]; link < cuts[s]; link += costs.grain)
            cost += unit_cost(phases, link, std::min(link + costs.grain, cuts[s]), costs);
        longest = std::max(longest, cost);
    }
    return longest;
}

void balance(const std::vector<model::Phase>& phases, std::span<int> cuts, const LinkCosts& costs) noexcept {
    const int links = static_cast<int>(phases.size()) / model::tips_per_link, segments = static_cast<int>(cuts.size()) - 1;
    const int units = (links + costs.grain - 1) / costs.grain;
    if (segments > units) return balance(phases, cuts, {costs.free, costs.touching, 1});
    const auto cost = [&](int unit) { return unit_cost(phases, costs.grain * unit, std::min(links, costs.grain * (unit + 1)), costs); };
    double total = 0.0;
    for (int unit = 0; unit < units; ++unit) total += cost(unit);
    double until = 0.0, before = 0.0;  // cost of the units before `at`, and before the one in front of it
    cuts.front() = 0;
    for (int s = 1, at = 0, last = 0; s < segments; ++s) {
        const double target = total * s / segments;
        for (; at < units && until < target; ++at) {
            before = until;
            until += cost(at);
        }
        const int nearest = at > 0 && target - before < until - target ? at - 1 : at;
        last = std::clamp(nearest, last + 1, units - (segments - s));
        cuts[static_cast<std::size_t>(s)] = costs.grain * last;
    }
    cuts.back() = links;
}

}  // namespace cvtflow::tasks
