#include "tasks/profile/stages.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace cvtflow::tasks {

namespace {

constexpr std::array<StageRow, 11> rows{{
    {Stage::enter, "enter", '>', false},
    {Stage::combine, "combine", 's', true},
    {Stage::contact, "contact forces", 'C', true},
    {Stage::chain, "chain forces", 'H', true},
    {Stage::force, "all forces (fused)", 'F', true},
    {Stage::boundary, "boundary pins", 'B', true},
    {Stage::cholesky, "Cholesky", 'K', true},
    {Stage::transition, "transition", 'T', true},
    {Stage::controller, "controller", 'c', false},
    {Stage::wait, "wait", '.', false},
    {Stage::exit, "exit", '<', false},
}};

struct TaskStage {
    std::string_view task;
    Stage stage;
};

constexpr std::array task_stages{
    TaskStage{"force", Stage::force},         TaskStage{"combine", Stage::combine},      TaskStage{"contact", Stage::contact},
    TaskStage{"chain", Stage::chain},         TaskStage{"boundary", Stage::boundary},    TaskStage{"forward", Stage::cholesky},
    TaskStage{"reverse", Stage::cholesky},    TaskStage{"detect", Stage::transition},    TaskStage{"locate", Stage::transition},
    TaskStage{"truncate", Stage::transition},
};

[[nodiscard]] Stage stage_of_code(int code) noexcept {
    switch (code) {
        case engine::span_controller: return Stage::controller;
        case engine::span_enter: return Stage::enter;
        case engine::span_exit: return Stage::exit;
        default: return Stage::wait;
    }
}

/// Cycles and levels, from how often the tasks of each cycle ran.
void count_cycles(const engine::TaskGraph& graph, const std::vector<double>& ran, RecordedPass& pass) {
    for (int cycle = 0; cycle < graph.cycles(); ++cycle) {
        const auto tasks = graph.topological(cycle);
        if (tasks.empty()) continue;
        double count = 0.0;
        for (const int task : tasks) count += ran[static_cast<std::size_t>(task)];
        const double cycles = count / static_cast<double>(tasks.size());
        pass.cycles += cycles;
        pass.levels += cycles * graph.levels(cycle);
        pass.task_count += count;
    }
}

}  // namespace

const std::array<StageRow, 11>& stages() noexcept { return rows; }

Stage stage_of(std::string_view task_name) {
    const std::string_view stem = task_name.substr(0, task_name.find('['));
    const auto found = std::find_if(task_stages.begin(), task_stages.end(), [&](const TaskStage& row) { return row.task == stem; });
    if (found == task_stages.end()) throw std::invalid_argument("profile: no stage for task '" + std::string(task_name) + "'");
    return found->stage;
}

double ThreadTimes::tasks() const noexcept {
    double sum = 0.0;
    for (const StageRow& row : rows) sum += row.task ? at(row.stage) : 0.0;
    return sum;
}

double ThreadTimes::total() const noexcept {
    double sum = 0.0;
    for (const double each : seconds) sum += each;
    return sum;
}

int RecordedPass::active() const noexcept {
    return static_cast<int>(std::count_if(threads.begin(), threads.end(), [](const ThreadTimes& thread) { return thread.tasks() > 0.0; }));
}

double RecordedPass::sum(Stage stage) const noexcept {
    double sum = 0.0;
    for (const ThreadTimes& thread : threads) sum += thread.at(stage);
    return sum;
}

double RecordedPass::tasks() const noexcept {
    double sum = 0.0;
    for (const ThreadTimes& thread : threads) sum += thread.tasks();
    return sum;
}

namespace {

/// [s], of all active threads together.
[[nodiscard]] double lost(const RecordedPass& pass) noexcept {
    double waits = 0.0;
    for (const ThreadTimes& thread : pass.threads) waits += thread.tasks() > 0.0 ? thread.at(Stage::wait) : 0.0;
    return waits - (pass.active() - 1) * pass.sum(Stage::controller);
}

}  // namespace

double RecordedPass::synchronisation() const noexcept { return active() == 0 || cycles == 0.0 ? 0.0 : lost(*this) / (active() * cycles); }

double RecordedPass::least_task() const noexcept { return active() == 0 || levels == 0.0 ? 0.0 : lost(*this) / (active() * levels); }

double RecordedPass::imbalance() const noexcept {
    double longest = 0.0;
    for (const ThreadTimes& thread : threads) longest = std::max(longest, thread.tasks());
    return active() == 0 ? 1.0 : longest * static_cast<double>(threads.size()) / tasks();
}

double RecordedPass::serial_share() const noexcept {
    const double serial = sum(Stage::controller) + sum(Stage::wait);
    return serial == 0.0 ? 0.0 : serial / (serial + tasks());
}

RecordedPass sum_up(const engine::TaskGraph& graph, const Spans& spans) {
    RecordedPass pass;
    std::vector<double> ran(static_cast<std::size_t>(graph.size()), 0.0);
    std::int64_t begin = 0, end = 0;
    for (const auto& thread : spans) {
        ThreadTimes times;
        for (const engine::Span& span : thread) {
            const Stage stage = span.what >= 0 ? stage_of(graph.task(span.what).name) : stage_of_code(span.what);
            times.seconds[static_cast<std::size_t>(stage)] += 1e-9 * static_cast<double>(span.end - span.begin);
            if (span.what >= 0) ran[static_cast<std::size_t>(span.what)] += 1.0;
        }
        if (!thread.empty()) {
            begin = pass.threads.empty() ? thread.front().begin : std::min(begin, thread.front().begin);
            end = std::max(end, thread.back().end);
        }
        pass.threads.push_back(times);
    }
    pass.wall = 1e-9 * static_cast<double>(end - begin);
    count_cycles(graph, ran, pass);
    return pass;
}

}  // namespace cvtflow::tasks
