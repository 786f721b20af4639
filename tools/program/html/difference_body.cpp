#include "tools/program/html/difference_body.hpp"

#include <fmt/format.h>

#include <cmath>

#include "tools/program/html/page.hpp"
#include "tools/program/text/markup.hpp"
#include "tools/program/text/text.hpp"
#include "tools/program/view/labels.hpp"
#include "tools/program/view/run_difference.hpp"
#include "tools/program/view/run_plots.hpp"

namespace cvtflow::tools {

namespace {

constexpr std::size_t columns_drawn_of_difference = 450;

std::string keys_that_differ(const RecordedRun& a, const RecordedRun& b) {
    if (!a.scene() || !b.scene()) return "<p>This program cannot read the scenes of both records.</p>\n";
    std::string rows;
    for (const KeyDifference& each : differing_keys(*a.scene(), *b.scene()))
        rows += fmt::format("<tr data-key=\"{0}\"><td><code>{0}</code></td><td>{1}</td><td>{2}</td><td>{3}</td></tr>\n", each.key,
                            html(each.a), html(each.b), html(each.meaning));
    if (rows.empty()) return "<p>Every key of both scenes has the same value.</p>\n";
    return "<table><caption>Keys of the scenes that "
           "differ</caption><thead><tr><th>key</th><th>A</th><th>B</th><th>meaning</th></tr></thead>"
           "<tbody>\n" +
           rows + "</tbody></table>\n";
}

std::string mean_cells(const MeanDifference& mean, double factor) {
    return number_cell(factor * mean.a, "{:.6g}") + number_cell(factor * mean.b, "{:.6g}") +
           number_cell(factor * mean.absolute(), "{:+.4g}") + number_cell(100.0 * mean.relative(), "{:+.3g} %");
}

std::string side_by_side(const RunDifference& d) {
    std::string rows;
    for (const ChannelDifference& each : d.channels) {
        const Shown how = shown(each.curve.name, each.curve.unit);
        rows += fmt::format("<tr data-difference=\"{0}\"><td title=\"{1}\">{0}</td><td>{2}</td>", html(each.curve.name),
                            html(each.curve.description), html(how.unit)) +
                mean_cells(each.all, how.factor) + mean_cells(each.last, how.factor) + number_cell(how.factor * each.largest, "{:.4g}") +
                fmt::format("<td class=\"number\" data-value=\"{:.9g}\">{}</td></tr>\n", each.largest_time, time_text(each.largest_time));
    }
    return "<table class=\"sortable\"><caption>Key figures side by side: means of all common rows, of the last fifth of them, and the "
           "largest "
           "difference</caption><thead><tr><th>channel</th><th>unit</th><th>A</th><th>B</th><th>B - A</th><th>of A</th><th>A, last "
           "fifth</th><th>B</th><th>B - A</th><th>of A</th><th>largest |B - A|</th><th>at</th></tr></thead><tbody>\n" +
           rows + "</tbody></table>\n";
}

/// Those that differ at all.
std::string curves_of_differences(const RunDifference& d) {
    std::string text, same;
    for (const ChannelDifference& each : d.channels) {
        if (each.largest == 0.0) {
            same += (same.empty() ? "" : ", ") + each.curve.name;
            continue;
        }
        const Shown how = shown(each.curve.name, each.curve.unit);
        std::vector<Point> points;
        for (std::size_t k = 0; k < d.times.size(); ++k) points.push_back({1e3 * d.times[k], how.factor * each.curve.values[k]});
        Plot plot;
        plot.title = each.curve.name + ": B - A";
        plot.x.label = "time [ms]";
        plot.y.label = how.unit.empty() ? "B - A" : fmt::format("B - A [{}]", how.unit);
        plot.height = 300.0;
        const bool dots = points.size() == 1;
        plot.series.push_back({"", thinned(points, columns_drawn_of_difference), dots ? Mark::dot : Mark::none, Line::solid, "", 1.4});
        text += "<figure>" + svg(plot) + "</figure>\n";
    }
    if (!same.empty()) text += fmt::format("<p>The same in every common row: {}.</p>\n", html(same));
    return text;
}

std::string channels_of_one(const char* which, const std::vector<std::string>& names) {
    if (names.empty()) return "";
    return fmt::format("<p>Only {} has {}.</p>\n", which, html(fmt::format("{}", fmt::join(names, ", "))));
}

std::string against(const RecordedRun& a, const RecordedRun& b) {
    std::string text = fmt::format("<h3>A: {}, B: {}</h3>\n", html(a.path()), html(b.path())) + keys_that_differ(a, b);
    const RunDifference d = difference(a, b);
    if (d.times.empty()) return text + "<p>The records have no common time, so their rows cannot be compared.</p>\n";
    if (a.times() != b.times())
        text += fmt::format("<p>Compared from {} to {}, at the {} times of A; B is interpolated to these times.</p>\n",
                            time_text(d.times.front()), time_text(d.times.back()), d.times.size());
    return text + side_by_side(d) + channels_of_one("A", d.only_a) + channels_of_one("B", d.only_b) + curves_of_differences(d);
}

}  // namespace

std::string difference_body(const std::vector<RecordedRun>& runs) {
    std::string text;
    for (std::size_t k = 1; k < runs.size(); ++k) text += against(runs.front(), runs[k]);
    return text;
}

}  // namespace cvtflow::tools
