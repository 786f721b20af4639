#include "bench/study/profile/stages.hpp"

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <string>

namespace cvtflow::bench {

namespace {

constexpr std::size_t behind_tasks = 3;  // controller, wait, exit

/// The first of a name's letters that no row has yet, in capitals if possible; then any.
[[nodiscard]] char free_letter(const std::string& name, const std::vector<StageRow>& rows) {
    std::string letters;
    for (const char c : name) letters += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    letters += name + "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789";
    for (const char letter : letters) {
        const bool taken = std::any_of(rows.begin(), rows.end(), [&](const StageRow& row) { return row.letter == letter; });
        if (std::isalnum(static_cast<unsigned char>(letter)) != 0 && !taken) return letter;
    }
    return '?';
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

StageTable::StageTable() : rows_{{"enter", '>', false}, {"controller", 'c', false}, {"wait", '.', false}, {"exit", '<', false}} {}

void StageTable::add(const engine::TaskGraph& graph) {
    for (int task = 0; task < graph.size(); ++task) {
        const std::string name = graph.task(task).stage_name();
        const bool known = std::any_of(rows_.begin(), rows_.end(), [&](const StageRow& row) { return row.task && row.name == name; });
        if (!known) rows_.insert(rows_.end() - behind_tasks, {name, free_letter(name, rows_), true});
    }
}

std::size_t StageTable::row(const std::string& name) const {
    const auto found = std::find_if(rows_.begin(), rows_.end(), [&](const StageRow& row) { return row.task && row.name == name; });
    if (found == rows_.end()) throw std::invalid_argument("profile: no task of these graphs has the stage '" + name + "'");
    return static_cast<std::size_t>(found - rows_.begin());
}

std::size_t StageTable::row(int code) const noexcept {
    switch (code) {
        case engine::span_enter: return 0;
        case engine::span_controller: return rows_.size() - 3;
        case engine::span_exit: return rows_.size() - 1;
        default: return rows_.size() - 2;
    }
}

double ThreadTimes::tasks() const noexcept {
    double sum = 0.0;
    for (std::size_t row = 1; row + behind_tasks < seconds.size(); ++row) sum += seconds[row];
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

double RecordedPass::sum(std::size_t row) const noexcept {
    double sum = 0.0;
    for (const ThreadTimes& thread : threads) sum += thread.at(row);
    return sum;
}

double RecordedPass::tasks() const noexcept {
    double sum = 0.0;
    for (const ThreadTimes& thread : threads) sum += thread.tasks();
    return sum;
}

double RecordedPass::controller() const noexcept {
    double sum = 0.0;
    for (const ThreadTimes& thread : threads) sum += thread.controller();
    return sum;
}

double RecordedPass::wait() const noexcept {
    double sum = 0.0;
    for (const ThreadTimes& thread : threads) sum += thread.wait();
    return sum;
}

namespace {

/// [s], of all active threads together.
[[nodiscard]] double lost(const RecordedPass& pass) noexcept {
    double waits = 0.0;
    for (const ThreadTimes& thread : pass.threads) waits += thread.tasks() > 0.0 ? thread.wait() : 0.0;
    return waits - (pass.active() - 1) * pass.controller();
}

}  // namespace

double RecordedPass::synchronisation() const noexcept { return active() == 0 || cycles == 0.0 ? 0.0 : lost(*this) / (active() * cycles); }

double RecordedPass::min_task() const noexcept { return active() == 0 || levels == 0.0 ? 0.0 : lost(*this) / (active() * levels); }

double RecordedPass::imbalance() const noexcept {
    double longest = 0.0;
    for (const ThreadTimes& thread : threads) longest = std::max(longest, thread.tasks());
    return active() == 0 ? 1.0 : longest * static_cast<double>(threads.size()) / tasks();
}

double RecordedPass::serial_share() const noexcept {
    const double serial = controller() + wait();
    return serial == 0.0 ? 0.0 : serial / (serial + tasks());
}

namespace {

/// Row of every task, so that each name is searched for once.
std::vector<std::size_t> rows_of_tasks(const engine::TaskGraph& graph, const StageTable& stages) {
    std::vector<std::size_t> rows;
    for (int task = 0; task < graph.size(); ++task) rows.push_back(stages.row(graph.task(task).stage_name()));
    return rows;
}

}  // namespace

RecordedPass sum_up(const engine::TaskGraph& graph, const StageTable& stages, const Spans& spans) {
    RecordedPass pass;
    std::vector<double> ran(static_cast<std::size_t>(graph.size()), 0.0);
    const std::vector<std::size_t> rows = rows_of_tasks(graph, stages);
    std::int64_t begin = 0, end = 0;
    for (const auto& thread : spans) {
        ThreadTimes times{std::vector<double>(stages.size(), 0.0)};
        for (const Span& span : thread) {
            const std::size_t row = span.what >= 0 ? rows[static_cast<std::size_t>(span.what)] : stages.row(span.what);
            times.seconds[row] += 1e-9 * static_cast<double>(span.end - span.begin);
            if (span.what >= 0) ran[static_cast<std::size_t>(span.what)] += 1.0;
        }
        if (!thread.empty()) {
            begin = pass.threads.empty() ? thread.front().begin : std::min(begin, thread.front().begin);
            end = std::max(end, thread.back().end);
        }
        pass.threads.push_back(std::move(times));
    }
    pass.wall = 1e-9 * static_cast<double>(end - begin);
    count_cycles(graph, ran, pass);
    return pass;
}

}  // namespace cvtflow::bench
