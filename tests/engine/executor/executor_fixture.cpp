#include "executor_fixture.hpp"

#include <chrono>
#include <filesystem>
#include <iterator>
#include <thread>

#include "engine/executor/serial.hpp"
#include "tests/sample_fixture.hpp"

namespace cvtflow::engine::test {

namespace {

/// splitmix64 (Steele, Lea, Flood 2014): a bijection that mixes well.
std::uint64_t mix(std::uint64_t x) noexcept {
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

}  // namespace

World::World(const std::vector<std::vector<int>>& cycles, unsigned seed, double edges) : random_(seed) {
    for (std::size_t cycle = 0; cycle < cycles.size(); ++cycle) {
        std::vector<int> before;
        for (const int width : cycles[cycle]) {
            std::vector<int> level;
            add_level(static_cast<int>(cycle), before, level, width, edges);
            before = level;
        }
    }
    graph_.freeze();
    cells_.resize(predecessors_.size());
}

void World::add_level(int cycle, const std::vector<int>& before, std::vector<int>& level, int width, double edges) {
    for (int i = 0; i < width; ++i) {
        const int task = graph_.add({"t" + std::to_string(graph_.size()), cycle, body, graph_.size(), {}});
        level.push_back(task);
        predecessors_.emplace_back();
        for (std::size_t j = 0; j < before.size(); ++j) {
            random_ = mix(random_);
            const bool chosen = static_cast<double>(random_ >> 11) * 0x1p-53 < edges;
            if (!chosen && j != static_cast<std::size_t>(i) % before.size()) continue;
            graph_.order(before[j], task);
            predecessors_.back().push_back(static_cast<std::size_t>(before[j]));
        }
    }
}

void World::run(Executor& executor, long cycles) {
    cells_.assign(cells_.size(), {});
    faults_ = 0;
    sequence_ = 0;
    epoch_ = 0;
    left_ = cycles;
    cycle_ = stop;
    executor.run(graph_, this, *this);
}

void World::body(void* world, int task) noexcept { static_cast<World*>(world)->run_task(static_cast<std::size_t>(task)); }

void World::run_task(std::size_t task) noexcept {
    Cell& written = cells_[task];
    if (written.epoch == epoch_ || graph_.task(static_cast<int>(task)).cycle != cycle_) ++faults_;
    std::uint64_t number = mix(written.number + task);
    for (const std::size_t before : predecessors_[task]) {
        if (cells_[before].epoch != epoch_) ++faults_;
        number = mix(number ^ cells_[before].number);
    }
    if (task_time_ > 0) {
        const auto until = std::chrono::steady_clock::now() + std::chrono::nanoseconds(task_time_);
        while (std::chrono::steady_clock::now() < until) {}
    }
    written = {epoch_, number};
}

void World::check_cycle() noexcept {
    for (const int task : graph_.topological(cycle_)) {
        if (cells_[static_cast<std::size_t>(task)].epoch != epoch_) ++faults_;
    }
}

int World::next() noexcept {
    if (cycle_ != stop) check_cycle();
    if (left_ == 0) return stop;
    if (epoch_ == odd_after_) return odd_cycle_;
    --left_;
    ++epoch_;
    sequence_ = mix(hash() + static_cast<std::uint64_t>(epoch_));
    cycle_ = static_cast<int>(sequence_ % static_cast<std::uint64_t>(graph_.cycles()));
    return cycle_;
}

std::uint64_t World::hash() const noexcept {
    std::uint64_t result = sequence_;
    for (const Cell& cell : cells_) result = mix(result ^ cell.number);
    return result;
}

std::uint64_t serial_hash(const std::vector<std::vector<int>>& cycles, long count, unsigned seed) {
    World world(cycles, seed);
    Serial serial;
    world.run(serial, count);
    return world.hash();
}

const std::vector<std::vector<int>>& mixed_cycles() {
    static const std::vector<std::vector<int>> cycles{{7}, {1}, {1, 2, 1}, {5, 1, 9}, {28}, {4, 4, 4}, {1, 1, 3}};
    return cycles;
}

std::vector<Case> all_cases() {
    std::vector<Case> cases;
    for (const ExecutorRow& row : executors()) {
        const bool plain = row.name == "serial" || row.name == "barrier";
        if (thread_sanitizer ? !plain : !plain && row.name != "flow" && !cvtflow::test::is_deep()) continue;
        for (const int threads : cvtflow::test::depth(std::vector{1, 2, 4}, std::vector{1, 2, 4, 8})) {
            if (row.parallel || threads == 1) cases.push_back({&row, threads});
        }
    }
    return cases;
}

std::vector<Case> pairs() {
    std::vector<Case> cases = all_cases();
    std::erase_if(cases, [](const Case& each) { return each.threads != (each.row->parallel ? 2 : 1); });
    return cases;
}

std::vector<Case> parallel_pairs() {
    std::vector<Case> cases = pairs();
    std::erase_if(cases, [](const Case& each) { return !each.row->parallel; });
    return cases;
}

int thread_count() {
    return static_cast<int>(std::distance(std::filesystem::directory_iterator("/proc/self/task"), std::filesystem::directory_iterator()));
}

bool falls_to_threads(int count) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (thread_count() != count && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return thread_count() == count;
}

}  // namespace cvtflow::engine::test
