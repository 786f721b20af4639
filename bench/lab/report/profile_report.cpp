#include "bench/lab/report/profile_report.hpp"

#include <fmt/format.h>

#include "engine/base/provenance.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

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

Plot curves_plot(const std::string& scene, const Profile& profile) {
    Plot plot;
    plot.title = fmt::format("Speed-up of {} by threads", scene);
    plot.subtitle = fmt::format("lines predict, dots are measured (best fused schedule); {}", measured_on());
    plot.x = {"threads", Scale::logarithmic, 1.0, {}, {}};
    plot.y = {"speed-up", Scale::logarithmic, 1.0, {}, {}};
    Series ideal{"ideal", {}, Mark::none, Line::dashed, "#999999"}, even{"whole links only", {}, Mark::none, Line::solid, ""},
        amdahl{"Amdahl", {}, Mark::none, Line::solid, ""}, path{"critical path", {}, Mark::none, Line::solid, "", 3.0},
        low{"its bounds", {}, Mark::none, Line::dashed, palette(2)}, high{"", {}, Mark::none, Line::dashed, palette(2)},
        measured{"measured", {}, Mark::square, Line::none, "#000000"};
    for (const SpeedUpRow& row : profile.model.curves) {
        const double threads = row.threads;
        ideal.points.push_back({threads, row.ideal});
        even.points.push_back({threads, row.even});
        amdahl.points.push_back({threads, row.amdahl});
        path.points.push_back({threads, row.predicted});
        low.points.push_back({threads, row.low});
        high.points.push_back({threads, row.high});
        const ScheduleResult* best = profile.best_fused(row.threads);
        if (best != nullptr) measured.points.push_back({threads, best->loads.front().speed_up});
    }
    plot.series = {std::move(ideal), std::move(even), std::move(amdahl),  std::move(path),
                   std::move(low),   std::move(high), std::move(measured)};
    return plot;
}

}  // namespace cvtflow::bench
