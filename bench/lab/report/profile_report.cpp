#include "bench/lab/report/profile_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "bench/study/profile/other_load.hpp"
#include "engine/base/provenance.hpp"
#include "tasks/schedule/schedule_chooser.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

std::string microseconds(double seconds) { return fmt::format("{:.2f}", 1e6 * seconds); }

std::string factor(double value) { return value >= 0.1 ? fmt::format("{:.2f}", value) : fmt::format("{:.2g}", value); }

Table::Column right(std::string heading) { return {std::move(heading), Align::right}; }

std::vector<std::string> schedule_cells(const ScheduleResult& result) {
    return {result.name, fmt::format("{}", result.schedule.threads), fmt::format("{}", result.schedule.segments)};
}

bool recorded(const ScheduleResult& result) { return result.recording.pass.active() > 0; }

std::string bare_text(const Profile& profile) {
    std::string text = "bare barrier, time per cycle:";
    for (const ThreadCost& cost : profile.bare)
        text += fmt::format(" {} us ({})", microseconds(cost.seconds), plural(cost.threads, "thread"));
    return text + "\n";
}

}  // namespace

std::string timing_text(const Profile& profile) {
    Table table({{"schedule"},
                 right("threads"),
                 right("segments"),
                 right("step [us]"),
                 right("quartiles"),
                 right("evaluation"),
                 right("speed-up"),
                 right("cpu/wall"),
                 right("active"),
                 right("sync"),
                 right("alone"),
                 right("bare"),
                 right("min task"),
                 right("imbalance"),
                 right("recording"),
                 {""}});
    for (const ScheduleResult& result : profile.results) {
        const LoadResult& load = result.loads.front();
        const RecordedPass& pass = result.recording.pass;
        std::vector<std::string> cells = schedule_cells(result);
        cells.insert(cells.end(), {microseconds(load.step.median),
                                   fmt::format("{} .. {}", microseconds(load.step.lower_quartile), microseconds(load.step.upper_quartile)),
                                   microseconds(load.evaluation), factor(load.speed_up), fmt::format("{:.2f}", load.cpu_per_wall)});
        const bool known = recorded(result);
        const bool came = result.cycle.active == result.schedule.threads;
        cells.insert(cells.end(), {known ? fmt::format("{}", pass.active()) : "", known ? microseconds(pass.synchronisation()) : "",
                                   came ? microseconds(result.cycle.seconds) : "absent", microseconds(result.bare),
                                   known ? microseconds(pass.min_task()) : "", known ? fmt::format("{:.2f}", pass.imbalance()) : "",
                                   known ? fmt::format("{:+.0f} %", 100.0 * result.recording.cost) : "", load.dropped});
        table.add(cells);
    }
    return table.text() + bare_text(profile);
}

std::string gains_text(const Profile& profile) {
    if (profile.processors_requested() < 2) return {};
    Table table({{"schedule"},
                 right("threads"),
                 right("segments"),
                 right("near"),
                 right("quartiles"),
                 right("rounds"),
                 right("far"),
                 right("quartiles"),
                 right("rounds")});
    const auto add = [&](std::vector<std::string> cells, const PairedGain& gain) {
        for (const auto& [spread, rounds] : {std::pair{gain.near, gain.near_rounds}, std::pair{gain.far, gain.far_rounds}}) {
            const bool known = rounds > 0;
            cells.insert(cells.end(), {known ? factor(spread.median) : "",
                                       known ? fmt::format("{} .. {}", factor(spread.lower_quartile), factor(spread.upper_quartile)) : "",
                                       fmt::format("{}", rounds)});
        }
        table.add(cells);
    };
    for (const ScheduleResult& result : profile.results)
        if (result.schedule.threads > 1) add(schedule_cells(result), result.paired);
    for (const CopiesGain& copies : profile.copies) add({"independent runs", fmt::format("{}", copies.threads), ""}, copies.paired);
    return fmt::format(
               "Speed-up against serial's turn of the same round, near: threads had just met within {} us, far: not; independent runs: as\n"
               "many serial ones at once, which share nothing\n",
               microseconds(tasks::ChooserOptions{}.meeting)) +
           table.text();
}

std::string neighbours_text(const Profile& profile) {
    const std::vector<LoadResult>& loads = profile.results.front().loads;
    if (loads.size() < 2) return {};
    std::vector<Table::Column> columns{{"schedule"}, right("threads"), right("segments")};
    for (const LoadResult& load : loads) {
        columns.push_back(right(fmt::format("{} busy [us]", load.neighbours)));
        columns.push_back(right("factor"));
        columns.push_back(right("burnt"));
    }
    Table table(columns);
    for (const ScheduleResult& result : profile.results) {
        std::vector<std::string> cells = schedule_cells(result);
        for (const LoadResult& load : result.loads) {
            const bool known = load.rounds > 0;
            cells.push_back(known ? microseconds(load.step.median) : "dropped");
            cells.push_back(known ? fmt::format("{}{}", factor(load.speed_up), load.dropped.empty() ? "" : "*") : "");
            cells.push_back(known ? microseconds(load.burnt) : "");
        }
        table.add(cells);
    }
    return "Beside busy neighbours: time per step, speed-up against serial under the same load (*: dropped after that round), processor "
           "time per step beyond serial's [us]\n" +
           table.text();
}

std::string stage_bar(const ThreadTimes& times, const std::vector<StageRow>& rows, int width) {
    std::vector<int> cells(rows.size());
    std::vector<double> rest(rows.size());
    const double total = times.total();
    if (total <= 0.0) return std::string(static_cast<std::size_t>(width), ' ');
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const double exact = width * times.at(k) / total;
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

std::string stages_text(const Profile& profile) {
    std::string text = "Stages by thread:";
    for (const StageRow& row : profile.stages.rows()) text += fmt::format(" {} {},", row.letter, row.name);
    text.back() = '\n';
    for (const ScheduleResult& result : profile.results) {
        const auto& threads = result.recording.pass.threads;
        for (std::size_t thread = 0; recorded(result) && thread < threads.size(); ++thread) {
            const std::string name = thread == 0 ? fmt::format("{} M={}", result.name, result.schedule.segments) : "";
            text += fmt::format("  {:<26} {:>2} |{}|", name, thread, stage_bar(threads[thread], profile.stages.rows(), 60));
            for (std::size_t row = 0; row < profile.stages.size(); ++row) {
                const double share = threads[thread].at(row) / threads[thread].total();
                if (share >= 0.005) text += fmt::format(" {} {:.0f}%", profile.stages.rows()[row].letter, 100.0 * share);
            }
            text += "\n";
        }
    }
    return text;
}

std::string serial_text(const Profile& profile) {
    const auto staged = std::find_if(profile.results.begin(), profile.results.end(),
                                     [](const ScheduleResult& result) { return result.name == "serial:staged"; });
    const ScheduleResult& serial = staged == profile.results.end() ? profile.results.front() : *staged;
    const RecordedPass& pass = serial.recording.pass;
    std::string text = fmt::format("Where sequential time goes ({}):\n", serial.name);
    double total = 0.0;
    for (const ThreadTimes& thread : pass.threads) total += thread.total();
    for (std::size_t row = 0; row < profile.stages.size(); ++row) {
        const double share = total > 0.0 ? pass.sum(row) / total : 0.0;
        if (share == 0.0) continue;
        const double per_step = serial.recording.steps > 0 ? pass.sum(row) / static_cast<double>(serial.recording.steps) : 0.0;
        text += fmt::format("  {:<20} {:>5.1f} % {:>9} us per step  {}\n", profile.stages.rows()[row].name, 100.0 * share,
                            microseconds(per_step), std::string(static_cast<std::size_t>(std::lround(50.0 * share)), '#'));
    }
    const double serial_share = profile.results.front().recording.pass.serial_share();
    return text + field("serial share", fmt::format("{:.2f} % of serial:fused; Amdahl's law allows {:.3g} with 16 threads",
                                                    100.0 * serial_share, 1.0 / (serial_share + (1.0 - serial_share) / 16.0)));
}

std::string crowding_text(const Profile& profile) {
    if (profile.calibrated < 0.0) return {};
    return fmt::format("calibration got {:.2f} of {} processors, the schedules {:.2f}; {:.2f} are required", profile.calibrated,
                       profile.processors_requested(), profile.processors_got(), crowded_below * profile.processors_requested());
}

namespace {

std::string numbered(std::size_t number, const ScheduleResult& result) {
    return fmt::format("{} {}, {}, {}", number, result.name, plural(result.schedule.threads, "thread"),
                       plural(result.schedule.segments, "segment"));
}

std::string measured_on() {
    const engine::Provenance here = engine::current_provenance();
    return fmt::format("{}, {} usable processors, commit {}", here.cpu, tasks::usable_threads(), here.commit);
}

/// Colours repeat after eight.
Line line_of_series(std::size_t series) { return series < 8 ? Line::solid : Line::dashed; }

}  // namespace

Plot stages_plot(const std::string& scene, const Profile& profile) {
    Plot plot;
    plot.title = fmt::format("Stages of a step of {}", scene);
    plot.subtitle = measured_on();
    plot.x = {"schedule, by its number", Scale::linear, 1.0, 0.0, static_cast<double>(profile.results.size() + 1)};
    plot.y = {"time per step, all threads together [us]", Scale::logarithmic, 1.0, {}, {}};
    constexpr Mark marks[] = {Mark::dot, Mark::square, Mark::diamond, Mark::triangle, Mark::ring, Mark::cross};
    for (std::size_t row = 0; row < profile.stages.size(); ++row) {
        Series series{profile.stages.rows()[row].name, {}, marks[row / 8 % 6], Line::none, ""};
        for (std::size_t number = 0; number < profile.results.size(); ++number) {
            const Recording& recording = profile.results[number].recording;
            if (recording.steps == 0 || recording.pass.sum(row) <= 0.0) continue;
            series.points.push_back(
                {static_cast<double>(number + 1), 1e6 * recording.pass.sum(row) / static_cast<double>(recording.steps)});
        }
        if (!series.points.empty()) plot.series.push_back(std::move(series));
    }
    for (std::size_t number = 0; number < profile.results.size(); ++number)
        plot.series.push_back({numbered(number + 1, profile.results[number]), {}, Mark::none, Line::none, "#444444"});
    return plot;
}

Plot loads_plot(const std::string& scene, const Profile& profile) {
    Plot plot;
    plot.title = fmt::format("Time per step of {} beside busy neighbours", scene);
    plot.subtitle = measured_on();
    plot.x = {"busy neighbours", Scale::linear, 1.0, 0.0, {}};
    plot.y = {"time per step [us]", Scale::logarithmic, 1.0, {}, {}};
    for (const ScheduleResult& result : profile.results) {
        Series series{numbered(plot.series.size() + 1, result), {}, Mark::dot, line_of_series(plot.series.size()), ""};
        for (const LoadResult& load : result.loads) {
            if (load.rounds > 0) series.points.push_back({static_cast<double>(load.neighbours), 1e6 * load.step.median});
        }
        plot.series.push_back(std::move(series));
    }
    return plot;
}

}  // namespace cvtflow::bench
