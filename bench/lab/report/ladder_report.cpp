#include "bench/lab/report/ladder_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "bench/lab/text/watch_text.hpp"
#include "bench/study/profile/statistics.hpp"
#include "tasks/scene/csv.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/plot/plot.hpp"
#include "tools/program/text/report_columns.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

Table::Column right(const char* heading) { return {heading, Align::right}; }

/// Error of a figure; NaN if it was not determined.
struct Column {
    const char* heading;
    double (*error)(const DetailOutcome& is, const DetailOutcome& should);
    const char* format;
};
double off(double is, double should) { return should == 0.0 || is == 0.0 ? std::nan("") : 100.0 * (is / should - 1.0); }
using D = DetailOutcome;
constexpr Column errors[] = {
    {"tight %", [](const D& is, const D& should) { return off(is.tight, should.tight); }, "{:+.2f}"},
    {"slack %", [](const D& is, const D& should) { return off(is.slack, should.slack); }, "{:+.2f}"},
    {"slip %", [](const D& is, const D& should) { return off(is.slip, should.slip); }, "{:+.2f}"},
    {"pin end %", [](const D& is, const D& should) { return off(is.tip, should.tip); }, "{:+.2f}"},
    {"efficiency %-pt", [](const D& is, const D& should) { return 100.0 * (is.efficiency - should.efficiency); }, "{:+.3f}"},
    {"thrust ratio %", [](const D& is, const D& should) { return off(is.thrust, should.thrust); }, "{:+.2f}"},
    {"shift %/s", [](const D& is, const D& should) { return 100.0 * (is.shift - should.shift); }, "{:+.2f}"},
};

std::string cell(const Column& column, double value) { return std::isnan(value) ? "-" : fmt::format(fmt::runtime(column.format), value); }

/// Costs are relative to the level "fine".
double seconds_of_fine(const Ladder& ladder) {
    for (const DetailLevelResult& level : ladder.levels) {
        if (level.outcome.variant.preset == "fine") return level.seconds;
    }
    return std::nan("");
}

void print(const Ladder& ladder) {
    const DetailOutcome& exact = ladder.reference;
    fmt::print(
        "{}: {} has tight {:.1f} N, slack {:.1f} N, slip {:.4f} %, largest force of an end of a pin {:.1f} N, efficiency {:.3f} %, shift "
        "{:+.2f} %/s{}\n",
        ladder.point.name, exact.variant.name(), exact.tight, exact.slack, 100.0 * exact.slip, exact.tip, 100.0 * exact.efficiency,
        100.0 * exact.shift, exact.thrust == 0.0 ? "" : fmt::format(", thrust ratio {:.4f}", exact.thrust));
    std::vector<Table::Column> columns{{"detail"}, right("step us"), right("s/s"), right("of fine")};
    for (const Column& column : errors) columns.push_back(right(column.heading));
    columns.push_back({"status"});
    Table table(columns);
    for (const DetailLevelResult& level : ladder.levels) {
        std::vector<std::string> cells{level.outcome.variant.name(), fmt::format("{:.2f}", 1e6 * level.outcome.step),
                                       fmt::format("{:.2f}", level.seconds),
                                       fmt::format("{:.2f}", level.seconds / seconds_of_fine(ladder))};
        for (const Column& column : errors)
            cells.push_back(level.outcome.fault.empty() ? cell(column, column.error(level.outcome, exact)) : "-");
        cells.push_back(level.outcome.status);
        table.add(cells);
    }
    fmt::print("{}\n", table.text(2));
}

/// Medians and maxima of the errors over the points.
void print_summary(const std::vector<Ladder>& ladders) {
    if (ladders.size() < 2) return;
    std::vector<Table::Column> columns{{"detail"}, right("of fine")};
    for (const Column& column : errors) columns.push_back(right(column.heading));
    Table table(columns);
    for (std::size_t level = 0; level < ladders.front().levels.size(); ++level) {
        std::vector<double> shares;
        for (const Ladder& ladder : ladders) shares.push_back(ladder.levels[level].seconds / seconds_of_fine(ladder));
        std::vector<std::string> cells{ladders.front().levels[level].outcome.variant.name(), fmt::format("{:.2f}", median(shares))};
        for (const Column& column : errors) {
            std::vector<double> sizes;
            for (const Ladder& ladder : ladders) {
                const double error = std::abs(column.error(ladder.levels[level].outcome, ladder.reference));
                if (ladder.levels[level].outcome.fault.empty() && !std::isnan(error)) sizes.push_back(error);
            }
            cells.push_back(sizes.empty() ? "-"
                                          : fmt::format("{:.2f} ({:.2f})", median(sizes), *std::max_element(sizes.begin(), sizes.end())));
        }
        table.add(cells);
    }
    fmt::print("{} operating points: median of the magnitudes, maximum in brackets\n{}\n", ladders.size(), table.text(2));
}

std::string csv_row(const Ladder& ladder, const DetailOutcome& o, double seconds, double spread) {
    std::string row = fmt::format("{},{},{:g},{},{:.4g},{:.4g},{:.2g},", tasks::csv_cell(ladder.point.name, true), o.variant.preset,
                                  o.variant.share, o.coordinates, o.step, seconds, spread);
    if (!o.fault.empty()) return row + fmt::format(",,,,,,,,,{},,,,,,\n", tasks::csv_cell(o.status, true));
    return row + fmt::format("{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.4g},{},{:.3g},{}\n", o.tight, o.slack, o.tip, o.slip,
                             o.efficiency, o.ratio, o.shift, o.thrust == 0.0 ? "" : fmt::format("{:.6g}", o.thrust), o.drift,
                             watch_csv({}, o.watch));
}

std::string csv_of(const std::vector<Ladder>& ladders) {
    std::string text =
        "point,detail,share,coordinates,step_s,seconds,spread,tight_N,slack_N,pin_axial_N,slip,efficiency,ratio,shift_per_s,thrust_ratio,"
        "drift,";
    text += watch_heading + std::string("\n");
    for (const Ladder& ladder : ladders) {
        text += csv_row(ladder, ladder.reference, 0.0, 0.0);
        for (const DetailLevelResult& level : ladder.levels) text += csv_row(ladder, level.outcome, level.seconds, level.spread);
    }
    return text;
}

nlohmann::ordered_json row_json(const DetailOutcome& o, double seconds) {
    nlohmann::ordered_json row{{"detail", std::string(o.variant.preset)},
                               {"share", o.variant.share},
                               {"coordinates", o.coordinates},
                               {"step", o.step},
                               {"seconds", seconds}};
    if (!o.fault.empty()) {
        row.update({{"status", o.status}, {"fault", o.fault}});
        return row;
    }
    const nlohmann::ordered_json figures{{"tight", o.tight},
                                         {"slack", o.slack},
                                         {"pin_axial", o.tip},
                                         {"slip", o.slip},
                                         {"efficiency", o.efficiency},
                                         {"ratio", o.ratio},
                                         {"shift", o.shift},
                                         {"thrust_ratio", o.thrust == 0.0 ? std::nan("") : o.thrust},
                                         {"drift", o.drift}};
    row.update(figures);
    row.update(watch_json({}, o.watch));
    return row;
}

std::string json_of(const std::vector<Ladder>& ladders, const DetailArguments& arguments) {
    auto points = nlohmann::ordered_json::array();
    for (const Ladder& ladder : ladders) {
        auto rows = nlohmann::ordered_json::array();
        for (const DetailLevelResult& level : ladder.levels) rows.push_back(row_json(level.outcome, level.seconds));
        points.push_back({{"point", ladder.point.name},
                          {"scene", ladder.point.scene},
                          {"settings", ladder.point.settings},
                          {"reference", row_json(ladder.reference, 0.0)},
                          {"levels", rows}});
    }
    return json_text({{"provenance", provenance_json()},
                      {"method", arguments.method},
                      {"step", arguments.step},
                      {"settle", arguments.settle},
                      {"average", arguments.average},
                      {"points", points}});
}

/// Error of slip against cost, one series per level.
std::string picture(const std::vector<Ladder>& ladders) {
    Plot plot;
    plot.title = "Cost of levels of detail and error of slip";
    plot.x = {"processor time per simulated second [s/s]", Scale::logarithmic, 1.0, {}, {}};
    plot.y = {"error of slip [%]", Scale::logarithmic, 1.0, {}, {}};
    for (std::size_t level = 0; level < ladders.front().levels.size(); ++level) {
        Series series{.name = ladders.front().levels[level].outcome.variant.name(), .points = {}, .line = Line::none, .colour = {}};
        for (const Ladder& ladder : ladders) {
            const DetailLevelResult& here = ladder.levels[level];
            if (here.outcome.fault.empty())
                series.points.push_back({here.seconds, std::abs(off(here.outcome.slip, ladder.reference.slip))});
        }
        plot.series.push_back(series);
    }
    return svg(plot);
}

}  // namespace

ExitStatus report_ladder(const DetailArguments& arguments, const OutputArguments& output) {
    std::vector<Ladder> ladders;
    bool complete = true;
    for (const LadderPoint& point : ladder_points(arguments)) {
        ladders.push_back(measure_ladder(arguments, point));
        if (catch_interrupts().requested()) return ExitStatus::cancelled;
        print(ladders.back());
        std::fflush(stdout);
        for (const DetailLevelResult& level : ladders.back().levels) {
            if (level.outcome.fault.empty()) continue;
            print_error(fmt::format("{}: {}: {}", point.name, level.outcome.variant.name(), level.outcome.fault));
            complete = false;
        }
    }
    print_summary(ladders);
    OutputFolder folder(output);
    folder.write("ladder.csv", csv_of(ladders));
    folder.write("ladder.json", json_of(ladders, arguments));
    folder.write("ladder.svg", picture(ladders));
    fmt::print(
        "s/s: processor time per simulated second, levels alternating; of fine: relative to \"fine\"; thrust ratio: S_1/S_2 at which ratio "
        "control holds\nthe ratio of the reference; shift: relative rate of change of the speed ratio.\n{}",
        folder.written());
    return complete ? ExitStatus::finished : ExitStatus::incomplete;
}

}  // namespace cvtflow::bench
