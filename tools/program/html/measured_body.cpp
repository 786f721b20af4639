#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/program/guard.hpp"
#include "tools/program/html/page.hpp"
#include "tools/program/text/markup.hpp"
#include "tools/program/text/text.hpp"
#include "tools/program/view/run_plots.hpp"

namespace cvtflow::tools {

namespace {

/// How far the curve of a record is, as it is drawn, from the points measured within its time, a row of a table.
std::string deviation_row(const RecordedRun& run, const engine::ChannelInfo& channel, const Measured& measured) {
    const DrawnCurve simulated = drawn_curve(run, channel);
    const MeasuredColumn &time = measured.at("time", "s"), &column = measured.at(channel.name, channel.unit);
    double sum = 0.0, squares = 0.0, largest = 0.0;
    long count = 0;
    for (std::size_t k = 0; k < column.values.size(); ++k) {
        if (!(time.values[k] >= simulated.times.front() && time.values[k] <= simulated.times.back())) continue;
        const double deviation = on_line(simulated.times, simulated.values, time.values[k]) - column.values[k];
        if (!std::isfinite(deviation)) continue;
        sum += deviation, squares += deviation * deviation, ++count;
        if (std::abs(deviation) > std::abs(largest)) largest = deviation;
    }
    const Shown how = shown(channel.name, channel.unit);
    const double points = static_cast<double>(count);
    return fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td class=\"number\" data-value=\"{}\">{}</td>", html(run.path()),
                       html(channel.name), html(how.unit), count, count) +
           number_cell(how.factor * sum / points, "{:+.4g}") + number_cell(how.factor * std::sqrt(squares / points), "{:.4g}") +
           number_cell(how.factor * largest, "{:+.4g}") + "</tr>\n";
}

}  // namespace

std::string measured_body(const std::vector<RecordedRun>& runs, const Measured& measured) {
    std::string pictures, rows;
    for (const engine::ChannelInfo& channel : runs.front().reader().channels()) {
        if (channel.width > 1 || measured.find(channel.name, channel.unit) == nullptr) continue;
        for (const Plot& plot : time_plots(runs, {channel.name}, false, &measured)) pictures += "<figure>" + svg(plot) + "</figure>\n";
        for (const RecordedRun& run : runs)
            if (run.channel(channel.name) != nullptr) rows += deviation_row(run, channel, measured);
    }
    if (pictures.empty())
        throw UsageError(fmt::format("--with {}: no heading is a channel of {}: {}", measured.path, runs.front().path(), measured.names()));
    return pictures +
           table("sortable",
                 "Simulated - measured, at the measured times within the record, between the points of the curves that are drawn",
                 {"record", "channel", "unit", "points", "mean", "root mean square", "largest"}, rows);
}

std::string measured_body(const SweepView& sweep, const Measured& measured) {
    const SweepColumn* key = nullptr;
    std::vector<const SweepColumn*> outputs;
    for (const SweepColumn& column : sweep.columns) {
        if (!column.number || measured.find(column.name, column.unit) == nullptr) continue;
        if (!column.axis)
            outputs.push_back(&column);
        else if (key == nullptr)
            key = &column;
    }
    if (key == nullptr || outputs.empty())
        throw UsageError(fmt::format("--with {}: a key and an output of {} are needed among its headings: {}", measured.path, sweep.path,
                                     measured.names()));
    std::string pictures;
    for (const SweepColumn* output : outputs)
        pictures += "<figure>" + svg(sweep_curves(sweep, key->name, output->name, &measured)) + "</figure>\n";
    return pictures;
}

}  // namespace cvtflow::tools
