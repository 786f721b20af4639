#include "tools/profile_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tools/text.hpp"

namespace cvtflow::tools {

namespace {

using tasks::LoadResult;
using tasks::ScheduleResult;
using tasks::StageRow;

std::string microseconds(double seconds) { return fmt::format("{:.2f}", 1e6 * seconds); }

std::string factor(double value) { return value >= 0.1 ? fmt::format("{:.2f}", value) : fmt::format("{:.2g}", value); }

Table::Column right(std::string heading) { return {std::move(heading), Align::right}; }

std::vector<std::string> schedule_cells(const ScheduleResult& result) {
    return {result.name, fmt::format("{}", result.schedule.threads), fmt::format("{}", result.schedule.segments)};
}

bool recorded(const ScheduleResult& result) { return result.recording.pass.active() > 0; }

std::string bare_text(const tasks::Profile& profile) {
    std::string text = "bare barrier, time per cycle:";
    for (const tasks::ThreadCost& cost : profile.bare) text += fmt::format(" {} us ({})", microseconds(cost.seconds), plural(cost.threads, "thread"));
    return text + "\n";
}

}  // namespace

std::string timing_text(const tasks::Profile& profile) {
    Table table({{"schedule"}, right("threads"), right("segments"), right("step [us]"), right("quartiles"), right("evaluation"), right("speed-up"),
                 right("cpu/wall"), right("active"), right("sync"), right("alone"), right("least task"), right("imbalance"), right("recording"), {""}});
    for (const ScheduleResult& result : profile.results) {
        const LoadResult& load = result.loads.front();
        const tasks::RecordedPass& pass = result.recording.pass;
        std::vector<std::string> cells = schedule_cells(result);
        cells.insert(cells.end(), {microseconds(load.step.median), fmt::format("{} .. {}", microseconds(load.step.lower_quartile), microseconds(load.step.upper_quartile)),
                                   microseconds(load.evaluation), factor(load.speed_up), fmt::format("{:.2f}", load.cpu_per_wall)});
        const bool known = recorded(result);
        const bool came = result.cycle.active == result.schedule.threads;
        cells.insert(cells.end(), {known ? fmt::format("{}", pass.active()) : "", known ? microseconds(pass.synchronisation()) : "",
                                   came ? microseconds(result.cycle.seconds) : "absent", known ? microseconds(pass.least_task()) : "",
                                   known ? fmt::format("{:.2f}", pass.imbalance()) : "", known ? fmt::format("{:+.0f} %", 100.0 * result.recording.cost) : "", load.dropped});
        table.add(cells);
    }
    return table.text() + bare_text(profile);
}

std::string neighbours_text(const tasks::Profile& profile) {
    const std::vector<LoadResult>& loads = profile.results.front().loads;
    if (loads.size() < 2) return {};
    std::vector<Table::Column> columns{{"schedule"}, right("threads"), right("segments")};
    for (const LoadResult& load : loads) {
        columns.push_back(right(fmt::format("{} busy [us]", load.neighbours)));
        columns.push_back(right("factor"));
    }
    Table table(columns);
    for (const ScheduleResult& result : profile.results) {
        std::vector<std::string> cells = schedule_cells(result);
        for (const LoadResult& load : result.loads) {
            const bool known = load.rounds > 0;
            cells.push_back(known ? microseconds(load.step.median) : "dropped");
            cells.push_back(known ? fmt::format("{}{}", factor(load.speed_up), load.dropped.empty() ? "" : "*") : "");
        }
        table.add(cells);
    }
    return "Beside busy neighbours: time per step, speed-up against serial under the same load (*: dropped after that round)\n" + table.text();
}

std::string stage_bar(const tasks::ThreadTimes& times, int width) {
    const auto& rows = tasks::stages();
    std::array<int, 11> cells{};
    std::array<double, 11> rest{};
    const double total = times.total();
    if (total <= 0.0) return std::string(static_cast<std::size_t>(width), ' ');
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const double exact = width * times.at(rows[k].stage) / total;
        cells[k] = static_cast<int>(std::floor(exact));
        rest[k] = exact - cells[k];
    }
    for (int left = width - std::accumulate(cells.begin(), cells.end(), 0); left > 0; --left) {
        const auto most = std::max_element(rest.begin(), rest.end());
        ++cells[static_cast<std::size_t>(most - rest.begin())];
        *most = 0.0;
    }
    std::string bar;
    for (std::size_t k = 0; k < rows.size(); ++k) bar += std::string(static_cast<std::size_t>(cells[k]), rows[k].letter);
    return bar;
}

std::string stages_text(const tasks::Profile& profile) {
    std::string text = "Stages by thread:";
    for (const StageRow& row : tasks::stages()) text += fmt::format(" {} {},", row.letter, row.name);
    text.back() = '\n';
    for (const ScheduleResult& result : profile.results) {
        const auto& threads = result.recording.pass.threads;
        for (std::size_t thread = 0; recorded(result) && thread < threads.size(); ++thread) {
            const std::string name = thread == 0 ? fmt::format("{} M={}", result.name, result.schedule.segments) : "";
            text += fmt::format("  {:<26} {:>2} |{}|", name, thread, stage_bar(threads[thread], 60));
            for (const StageRow& row : tasks::stages()) {
                const double share = threads[thread].at(row.stage) / threads[thread].total();
                if (share >= 0.005) text += fmt::format(" {} {:.0f}%", row.letter, 100.0 * share);
            }
            text += "\n";
        }
    }
    return text;
}

std::string serial_text(const tasks::Profile& profile) {
    const auto staged = std::find_if(profile.results.begin(), profile.results.end(), [](const ScheduleResult& result) { return result.name == "serial:staged"; });
    const ScheduleResult& serial = staged == profile.results.end() ? profile.results.front() : *staged;
    const tasks::RecordedPass& pass = serial.recording.pass;
    std::string text = fmt::format("Where sequential time goes ({}):\n", serial.name);
    double total = 0.0;
    for (const tasks::ThreadTimes& thread : pass.threads) total += thread.total();
    for (const StageRow& row : tasks::stages()) {
        const double share = total > 0.0 ? pass.sum(row.stage) / total : 0.0;
        if (share == 0.0) continue;
        const double per_step = serial.recording.steps > 0 ? pass.sum(row.stage) / static_cast<double>(serial.recording.steps) : 0.0;
        text += fmt::format("  {:<20} {:>5.1f} % {:>9} us per step  {}\n", row.name, 100.0 * share, microseconds(per_step),
                            std::string(static_cast<std::size_t>(std::lround(50.0 * share)), '#'));
    }
    return text;
}

namespace {

/// Best measured speed-up of a fused schedule with so many threads; empty if none was measured.
std::string measured_cell(const tasks::Profile& profile, int threads) {
    const ScheduleResult* best = nullptr;
    for (const ScheduleResult& result : profile.results) {
        if (result.schedule.threads != threads || result.schedule.assembly.kind != tasks::Assembly::fused || result.loads.front().rounds == 0) continue;
        if (best == nullptr || result.loads.front().speed_up > best->loads.front().speed_up) best = &result;
    }
    return best == nullptr ? "" : fmt::format("{:.2f} ({})", best->loads.front().speed_up, best->schedule.executor);
}

}  // namespace

std::string model_text(const tasks::Profile& profile) {
    const tasks::PathCosts& costs = profile.model.costs;
    const auto touching = std::count(profile.model.touching.begin(), profile.model.touching.end(), true);
    std::string text = "Critical path (fused, a thread per segment):\n";
    text += field("link", fmt::format("{} us free, {} us touching ({} of {}), detection {} us", microseconds(costs.free), microseconds(costs.touching), touching,
                                      profile.model.touching.size(), microseconds(costs.detect)));
    text += field("segment", fmt::format("{} us per evaluation for the neighbours' joints", microseconds(costs.border)));
    text += field("controller", fmt::format("{} us per cycle, {:.2f} evaluations per step", microseconds(costs.controller), costs.evaluations));
    text += field("synchronisation", fmt::format("{} us + {} us x M per cycle, {}", microseconds(costs.synchronisation), microseconds(costs.per_thread),
                                                 profile.model.assumed ? "assumed: threads did not come, the machine is too busy" : "from"));
    text.pop_back();
    for (const tasks::ThreadCost& cost : profile.model.synchronisation) text += profile.model.assumed ? "" : fmt::format(" M = {}: {} us", cost.threads, microseconds(cost.seconds));
    if (profile.model.synchronisation.size() == 2) text += " (beyond, two samples extrapolated: take it as the pessimistic end)";
    text += "\n" + field("serial share", fmt::format("{:.2f} %", 100.0 * profile.model.serial_share));
    Table table({right("M"), right("ideal"), right("N/N_max"), right("Amdahl"), right("critical path"), right("measured")});
    for (const tasks::SpeedUpRow& row : profile.model.curves) {
        const std::string measured = measured_cell(profile, row.threads);
        const bool round = row.threads <= 4 || row.threads % 16 == 0 || (row.threads <= 16 && row.threads % 4 == 0) || row.threads == 6 || row.threads == 24;
        if (!round && measured.empty()) continue;
        table.add({fmt::format("{}", row.threads), fmt::format("{:.2f}", row.ideal), fmt::format("{:.2f}", row.even), fmt::format("{:.2f}", row.amdahl),
                   fmt::format("{:.2f}", row.predicted), measured});
    }
    return text + table.text(2);
}

}  // namespace cvtflow::tools
