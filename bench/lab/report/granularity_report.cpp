#include "bench/lab/report/granularity_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "bench/executor/further_executors.hpp"
#include "bench/study/profile/report.hpp"
#include "engine/base/provenance.hpp"
#include "tasks/scene/csv.hpp"
#include "tools/program/text/report_columns.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

using nlohmann::ordered_json;

namespace {

/// Whether the shortest tasks reach an efficiency of 50 %.
bool all_effective(const std::vector<GranularityPoint>& curve) {
    return !curve.empty() && effective_granularity(curve) == curve.front().length;
}

std::string granularity_cell(const std::vector<GranularityPoint>& curve) {
    const double length = effective_granularity(curve);
    if (!std::isfinite(length)) return "-";
    return fmt::format("{}{:.3g}", all_effective(curve) ? "<" : "", 1e6 * length);
}

std::string conditions(const Granularity& result) {
    const engine::Provenance here = engine::current_provenance();
    return fmt::format("{} threads on {}; calibration got {:.2f} of {} processors{}; commit {}", result.requested, here.cpu,
                       result.calibrated, result.requested, result.crowded() ? ", other processes are busy" : "", here.commit);
}

/// Colours repeat after eight.
Line line_of_curve(std::size_t series) { return series < 8 ? Line::solid : Line::dashed; }

std::string in_quotes(const std::string& text) { return tasks::csv_cell(text, true, true); }

}  // namespace

std::string granularity_table(const Granularity& result) {
    std::vector<Table::Column> columns{{"executor"}};
    for (const int tasks : result.tasks()) columns.push_back({fmt::format("M = {}", tasks), Align::right});
    Table table(columns);
    for (const std::string& executor : result.executors()) {
        std::vector<std::string> cells{executor};
        for (const int tasks : result.tasks()) cells.push_back(granularity_cell(result.curve(executor, tasks)));
        table.add(cells);
    }
    return table.text(2);
}

std::string granularity_csv(const Granularity& result) {
    std::string text =
        "executor,threads,tasks,length_us,efficiency,efficiency_lower_quartile,efficiency_upper_quartile,cycle_us,ideal_us,calibrated,"
        "processors,commit,compiler,flags,runtimes,cpu,cores,date\n";
    const engine::Provenance here = engine::current_provenance();
    const std::string provenance = fmt::format("{:.3f},{},{},{},{},{},{},{},{}", result.calibrated, result.requested, here.commit,
                                               in_quotes(here.compiler + " " + here.build_type), in_quotes(compiler_flags()),
                                               in_quotes(bench::runtime_versions()), in_quotes(here.cpu), here.cores, here.date);
    for (const GranularityPoint& point : result.points) {
        const Spread& efficiency = point.efficiency;
        text += fmt::format("{},{},{},{:.4g},{:.5f},{:.5f},{:.5f},{:.5g},{:.5g},{}\n", point.executor, point.threads, point.tasks,
                            1e6 * point.length, efficiency.median, efficiency.lower_quartile, efficiency.upper_quartile, 1e6 * point.cycle,
                            1e6 * point.ideal, provenance);
    }
    return text;
}

std::string granularity_json(const Granularity& result, const GranularityOptions& options) {
    ordered_json curves = ordered_json::array();
    for (const std::string& executor : result.executors()) {
        for (const int tasks : result.tasks()) {
            const std::vector<GranularityPoint> curve = result.curve(executor, tasks);
            ordered_json points = ordered_json::array();
            for (const GranularityPoint& point : curve) {
                points.push_back({{"length", point.length},
                                  {"cycle", point.cycle},
                                  {"ideal", point.ideal},
                                  {"efficiency", point.efficiency.median},
                                  {"lower_quartile", point.efficiency.lower_quartile},
                                  {"upper_quartile", point.efficiency.upper_quartile}});
            }
            curves.push_back({{"executor", executor},
                              {"threads", curve.front().threads},
                              {"tasks", tasks},
                              {"metg50", effective_granularity(curve)},
                              {"metg50_is_a_bound", all_effective(curve)},
                              {"points", points}});
        }
    }
    ordered_json provenance = provenance_json();
    provenance["flags"] = compiler_flags();
    provenance["runtimes"] = bench::runtime_versions();
    return json_text({{"provenance", provenance},
                      {"options",
                       {{"levels", options.levels},
                        {"work", options.work},
                        {"patience", options.timeout},
                        {"rounds", options.rounds},
                        {"pin", options.pin}}},
                      {"processors", {{"requested", result.requested}, {"calibrated", result.calibrated}, {"crowded", result.crowded()}}},
                      {"curves", curves}});
}

std::vector<Plot> efficiency_plots(const Granularity& result) {
    std::vector<Plot> plots;
    for (const int tasks : result.tasks()) {
        Plot plot;
        plot.title = fmt::format("Efficiency against the length of a task, {} per level", plural(tasks, "task"));
        plot.subtitle = conditions(result);
        plot.x = {"length of a task [us]", Scale::logarithmic, 1.0, {}, {}};
        plot.y = {"efficiency", Scale::linear, 1.0, 0.0, 1.1};
        for (const std::string& executor : result.executors()) {
            Series series{executor, {}, Mark::small_dot, line_of_curve(plot.series.size()), ""};
            for (const GranularityPoint& point : result.curve(executor, tasks))
                series.points.push_back({1e6 * point.length, point.efficiency.median});
            plot.series.push_back(std::move(series));
        }
        plots.push_back(std::move(plot));
    }
    return plots;
}

Plot granularity_plot(const Granularity& result) {
    Plot plot;
    plot.title = "Shortest tasks with half of the efficiency: METG(50 %)";
    plot.subtitle = conditions(result) + "; triangles: upper bounds";
    plot.x = {"tasks per level", Scale::logarithmic, 1.0, {}, {}};
    plot.y = {"METG(50 %) [us]", Scale::logarithmic, 1.0, {}, {}};
    std::vector<Series> bounds;
    for (const std::string& executor : result.executors()) {
        Series series{executor, {}, Mark::dot, line_of_curve(plot.series.size()), palette(plot.series.size())};
        Series bound{"", {}, Mark::triangle, Line::none, series.colour};
        for (const int tasks : result.tasks()) {
            const std::vector<GranularityPoint> curve = result.curve(executor, tasks);
            (all_effective(curve) ? bound : series).points.push_back({static_cast<double>(tasks), 1e6 * effective_granularity(curve)});
        }
        plot.series.push_back(std::move(series));
        if (!bound.points.empty()) bounds.push_back(std::move(bound));
    }
    plot.series.insert(plot.series.end(), bounds.begin(), bounds.end());
    return plot;
}

}  // namespace cvtflow::bench
