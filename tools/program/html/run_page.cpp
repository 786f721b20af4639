#include "tools/program/html/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <vector>

#include "tasks/run/run_means.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/text/markup.hpp"
#include "tools/program/text/scene_text.hpp"
#include "tools/program/text/text.hpp"
#include "tools/program/view/recorded_run.hpp"
#include "tools/program/view/run_plots.hpp"

namespace cvtflow::tools {

namespace {

constexpr std::size_t bytes_of_curves = 1500000;  ///< of all records together, as text
constexpr std::size_t max_states = 1000;          ///< of the running chain
constexpr std::size_t columns_of_picture = 450;

std::string attribute(const RecordedRun& run, std::string_view name) { return text_of(run.reader().attributes(), name, ""); }

std::string item(const std::string& kind, const std::string& text) { return fmt::format("<li class=\"{}\">{}</li>\n", kind, text); }

/// Status and warnings, shown first.
std::string status_list(const RecordedRun& run) {
    const std::string& status = run.reader().status();
    const bool good = status == "finished", running = status == "running";
    std::string text = item(good ? "good" : "bad",
                            fmt::format("<b>{}</b>{}", html(status), running ? " (still being written, or left by a killed run)" : ""));
    const double* doubt = engine::attribute_value<double>(run.reader().attributes(), "energy_suspicion");
    if (doubt != nullptr)
        text += item(*doubt <= 1.0 ? "good" : "bad", fmt::format("energy balance {}: residual {} of the losses, {:.2g} of the tolerance",
                                                                 *doubt <= 1.0 ? "closes" : "does not close, the results are unreliable",
                                                                 html(attribute(run, "energy_residual_relative")), *doubt));
    const std::string notes = attribute(run, "notes");
    for (const tasks::NoteKind& kind : tasks::note_kinds()) {
        if (notes.find(kind.name) != std::string::npos) text += item("note", fmt::format("<b>{}</b>: {}", kind.name, html(kind.meaning)));
    }
    if (!run.reader().sealed()) text += item("note", "the record has no seal: its numbers cannot be verified");
    return fmt::format("<ul class=\"status\">\n{}</ul>\n", text);
}

/// Keys whose values are not the defaults, folded; of several records those that all share.
std::string differences(const std::vector<RecordedRun>& runs) {
    const tasks::Scene& scene = *runs.front().scene();
    std::vector<tasks::KeyDifference> keys = differing_keys(scene, {});
    for (const RecordedRun& run : runs) {
        const std::vector<tasks::KeyDifference> apart = differing_keys(scene, *run.scene());
        std::erase_if(keys, [&](const auto& key) { return std::ranges::count(apart, key.key, &tasks::KeyDifference::key) > 0; });
    }
    return default_differences(keys, runs.size() > 1 ? "records" : "");
}

/// Mean power that flows into a shaft from outside [W]; NaN if the record does not contain it.
double power_into(const RecordedRun& run, int shaft) {
    const std::vector<double> torque = run.values(fmt::format("shaft_{}/torque", shaft));
    const std::vector<double> speed = run.values(fmt::format("shaft_{}/speed", shaft));
    if (torque.empty() || torque.size() != speed.size()) return NAN;
    return std::inner_product(torque.begin(), torque.end(), speed.begin(), 0.0) / static_cast<double>(torque.size());
}

/// "shaft 1 drives: 31.7 kW in, shaft 2 delivers 31.3 kW"; empty if the record does not contain it.
std::string drive_text(const RecordedRun& run) {
    const double first = power_into(run, 1), second = power_into(run, 2);
    if (!std::isfinite(first) || !std::isfinite(second)) return "";
    const bool one = first >= second;
    const double in = one ? first : second, out = one ? -second : -first;
    return fmt::format("shaft {} drives ({:.3g} kW in), shaft {} {} ({:.3g} kW)", one ? 1 : 2, 1e-3 * in, one ? 2 : 1,
                       out >= 0.0 ? "delivers" : "also takes", 1e-3 * std::abs(out));
}

using Rows = std::vector<std::pair<std::string, std::string>>;  ///< of a definition table: label, HTML

Rows simulated(const RecordedRun& run) {
    const auto& times = run.times();
    Rows rows{{"record", html(run.path())}, {"scene", html(run.name())}};
    if (run.scene()) rows.insert(rows.end(), {{"", html(run.scene()->description)}, {"detail", html(detail_text(*run.scene()))}});
    rows.push_back({"conditions", html(run.conditions())});
    if (const std::string drive = drive_text(run); !drive.empty()) rows.push_back({"power", html(drive)});
    rows.push_back({"time", fmt::format("{} to {}, {} rows, {} states", time_text(times.front()), time_text(times.back()),
                                        count_text(static_cast<long>(times.size())), run.reader().state_times().size())});
    return rows;
}

/// Rows that all records share once, then the rest of each.
std::string simulated(const std::vector<RecordedRun>& runs) {
    Rows common = simulated(runs.front());
    for (const RecordedRun& run : runs) {
        const Rows other = simulated(run);
        std::erase_if(common, [&](const auto& row) { return std::ranges::count(other, row) == 0; });
    }
    std::string text = definition_table(common);
    for (const RecordedRun& run : runs) {
        Rows rest = simulated(run);
        std::erase_if(rest, [&](const auto& row) { return std::ranges::count(common, row) > 0; });
        if (!rest.empty()) text += definition_table(rest);
    }
    const bool readable = std::ranges::all_of(runs, [](const RecordedRun& run) { return run.scene().has_value(); });
    return text + (readable ? differences(runs) : "<p>This program cannot read the record's scene.</p>\n");
}

/// Mean of all rows, of the last fifth, least and largest.
std::string figures(const RecordedRun& run) {
    const bool steady = run.scene() && run.scene()->run.until.automatic();
    std::string rows;
    for (const Curve& curve : run.overview()) {
        const std::span<const double> values = curve.values;
        const std::size_t late = std::min(values.size() - 1, steady ? values.size() / 2 : 4 * values.size() / 5);
        FiniteFigures all(values), last(values.subspan(late));
        all.mean = run.efficiency(curve.name, run.times().front(), run.times().back()).value_or(all.mean);
        last.mean = run.efficiency(curve.name, run.times()[late], run.times().back()).value_or(last.mean);
        const Shown how = shown(curve.name, curve.unit);
        rows += fmt::format("<tr data-channel=\"{0}\"><td title=\"{1}\">{0}</td><td>{2}</td>", html(curve.name), html(curve.description),
                            html(how.unit));
        for (const double number : {all.mean, last.mean, all.least, all.largest}) rows += number_cell(how.factor * number, "{:.6g}");
        rows += fmt::format("<td class=\"meaning\">{}</td></tr>\n", html(curve.description));
    }
    return table("sortable", html(run.path()),
                 {"channel", "unit", "mean", steady ? "mean of the last half, which is steady" : "mean of the last fifth", "least",
                  "largest", "meaning"},
                 rows);
}

/// Increase of each channel of accumulated energy over the record, by kind. Empty if the record has none.
std::string energies(const RecordedRun& run) {
    std::string rows;
    for (const char* group : {"work", "dissipated", "hydraulics", "vehicle"}) {
        for (const Curve& curve : run.group(group)) {
            const double gained = curve.values.back() - curve.values.front();
            if (curve.unit != "J" || gained == 0.0) continue;
            rows += fmt::format("<tr><td>{}</td><td>{}</td><td class=\"number\" data-value=\"{:.9g}\">{:.6g}</td></tr>\n", html(curve.name),
                                html(curve.description), gained, gained);
        }
    }
    if (rows.empty()) return "";
    return table("sortable", "Energies over the record", {"channel", "meaning", "J"}, rows);
}

std::string picture(Plot plot) {
    for (Series& series : plot.series) series.points = thinned(series.points, columns_of_picture);
    return "<figure>" + svg(plot) + "</figure>\n";
}

std::string wear(const RecordedRun& run) {
    std::string text;
    for (Plot& plot : wear_plots(run)) text += picture(std::move(plot));
    return text;
}

template <class Each>
std::string of_all(const std::vector<RecordedRun>& runs, const Each& each) {
    std::string text;
    for (const RecordedRun& run : runs) text += (runs.size() > 1 ? fmt::format("<h3>{}</h3>\n", html(run.path())) : "") + each(run);
    return text;
}

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

/// Curves of the channels that were measured, with the measured points, and how far the records are from these.
/// @throws UsageError if no heading is a channel of the first record, or there is no column of times
std::string measured_curves(const std::vector<RecordedRun>& runs, const Measured& measured) {
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

/// Why a record has no spectra; empty if it has.
std::string without_spectra(const RecordedRun& run) {
    if (run.times().size() < 8 || !(run.times()[1] > run.times()[0])) return "spectra require at least 8 rows";
    if (attribute(run, "notes").find("unsteady") != std::string::npos)
        return "the run is unsteady, and a spectrum would contain the change of the operating point";
    return run.unresolved();
}

std::string spectra(const std::vector<RecordedRun>& runs) {
    for (const RecordedRun& run : runs) {
        if (const std::string why = without_spectra(run); !why.empty())
            return fmt::format("<p>No spectra: {}: {}.</p>\n", html(run.path()), html(why));
    }
    std::vector<std::string> words;
    for (const Curve& curve : runs.front().overview()) {
        const FiniteFigures figures(curve.values);
        if (figures.least < figures.largest) words.push_back(curve.name);
    }
    std::string text;
    for (const std::string& word : words) {
        for (Plot plot : order_plots(runs, {word})) plot.height = 320.0, text += picture(std::move(plot));
    }
    return text;
}

/// Rows in groups; of each group the minimum and the maximum are kept, in their order.
struct Stretches {
    std::ptrdiff_t rows, count;  ///< count: 0: every row is kept

    [[nodiscard]] std::ptrdiff_t begin(std::ptrdiff_t number) const noexcept { return number * rows / count; }
    /// Times that values() belong to.
    [[nodiscard]] std::vector<double> times(const std::vector<double>& all) const {
        if (count == 0) return all;
        std::vector<double> kept;
        for (std::ptrdiff_t k = 0; k < count; ++k) {
            kept.push_back(all[begin(k)]);
            kept.push_back(all[(begin(k) + begin(k + 1)) / 2]);
        }
        return kept;
    }
    [[nodiscard]] std::vector<float> values(const std::vector<double>& all) const {
        if (count == 0) return {all.begin(), all.end()};
        std::vector<float> kept;
        for (std::ptrdiff_t k = 0; k < count; ++k) {
            const auto from = all.begin() + begin(k), to = all.begin() + begin(k + 1);
            auto [first, second] = finite_extremes(from, to, [](double value) { return value; });
            if (second < first) std::swap(first, second);
            kept.push_back(static_cast<float>(*first));
            kept.push_back(static_cast<float>(*second));
        }
        return kept;
    }
};

bool constant(const Curve& curve) {
    return std::ranges::all_of(curve.values, [&](double value) { return value == curve.values.front(); });
}

/// In the units that people read.
std::vector<Curve> all_curves(const RecordedRun& run) {
    std::vector<Curve> curves;
    for (const engine::ChannelInfo& channel : run.reader().channels()) {
        const Shown how = shown(channel.name, channel.unit);
        for (Curve& curve : run.curves(channel)) {
            for (double& value : curve.values) value *= how.factor;
            curve.unit = how.unit;
            curves.push_back(std::move(curve));
        }
    }
    return curves;
}

/// All curves of a record, in at most about `max_bytes` bytes of text. {"label", "rows", "shown", "t", "curves": [{"n", "u", "d", "v" or
/// "c"}]}
nlohmann::json curve_data(const RecordedRun& run, std::size_t max_bytes) {
    const std::vector<Curve> curves = all_curves(run);
    const auto moving = static_cast<std::size_t>(std::count_if(curves.begin(), curves.end(), [](const Curve& c) { return !constant(c); }));
    const auto points = static_cast<std::ptrdiff_t>(max_bytes / (6 * (moving + 2)));  // a float takes 5.3 bytes of base64
    const auto rows = static_cast<std::ptrdiff_t>(run.times().size());
    const Stretches stretches{rows, rows <= points ? 0 : std::max<std::ptrdiff_t>(1, points / 2)};
    const std::vector<double> times = stretches.times(run.times());
    nlohmann::json list = nlohmann::json::array();
    for (const Curve& curve : curves) {
        nlohmann::json entry{{"n", curve.name}, {"u", curve.unit}, {"d", curve.description}};
        if (constant(curve))
            entry["c"] = curve.values.front();
        else
            entry["v"] = packed(stretches.values(curve.values));
        list.push_back(std::move(entry));
    }
    return {{"label", run.path()}, {"rows", rows}, {"shown", times.size()}, {"t", packed(times)}, {"curves", std::move(list)}};
}

/// Labels of the shafts are by the power that flows into them.
nlohmann::json motion_data(const RecordedRun& run, const ChainMotion& motion) {
    const model::Parameters& p = run.scene()->parameters;
    const bool pulleys = p.detail.pulleys != model::PulleyDetail::absent;
    nlohmann::json data{{"recorded", motion.recorded}, {"t", packed(motion.times)}, {"pins", p.chain.pins}, {"pulleys", pulleys}};
    data.update({{"x", quantised(motion.x)}, {"y", quantised(motion.y)}, {"z", quantised(motion.z)}, {"flank", p.tip.angle}});
    data.update({{"length", p.half.length}, {"width", p.half.width}, {"span", p.plate.span}, {"plates", p.plate.count}});
    data.update({{"distance", p.pulley.centre_distance}, {"innermost", p.pulley.innermost}, {"outermost", p.pulley.outermost}});
    data["colours"] = nlohmann::json::array();
    const auto add = [&](const char* name, const char* unit, std::vector<float> values) {
        const Shown how = shown(name, unit);
        for (float& value : values) value *= static_cast<float>(how.factor);
        if (!values.empty()) data["colours"].push_back({{"n", name}, {"u", how.unit}, {"v", quantised(values)}});
    };
    add("pin force", "N", motion.pin_force);
    add("tension", "N", motion.tension);
    if (pulleys) add("slip", "1", motion.slip);
    const bool first_drives = !(power_into(run, 1) < power_into(run, 2));
    data["labels"] = {first_drives ? "drive" : "driven", first_drives ? "driven" : "drive"};
    for (const std::size_t shaft : {0U, 1U})
        data["shafts"].push_back({{"angle", packed(motion.angle[shaft])}, {"radius", packed(motion.radius[shaft])}});
    return data;
}

std::string keys_that_differ(const RecordedRun& a, const RecordedRun& b) {
    if (!a.scene() || !b.scene()) return "<p>This program cannot read the scenes of both records.</p>\n";
    std::string rows;
    for (const tasks::KeyDifference& each : differing_keys(*a.scene(), *b.scene()))
        rows += fmt::format("<tr data-key=\"{0}\"><td><code>{0}</code></td><td>{1}</td><td>{2}</td><td>{3}</td></tr>\n", each.key->key,
                            html(each.a), html(each.b), html(each.key->meaning));
    if (rows.empty()) return "<p>Every key of both scenes has the same value.</p>\n";
    return table("", "Keys of the scenes that differ", {"key", "A", "B", "meaning"}, rows);
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
    return table("sortable", "Key figures side by side: means of all common rows, of the last fifth of them, and the largest difference",
                 {"channel", "unit", "A", "B", "B - A", "of A", "A, last fifth", "B", "B - A", "of A", "largest |B - A|", "at"}, rows);
}

/// Curves of the channels that differ.
std::string curves_of_differences(const RunDifference& d) {
    const Shown time = shown_time(d.times.back());
    std::string text, same;
    for (const ChannelDifference& each : d.channels) {
        if (each.largest == 0.0) {
            same += (same.empty() ? "" : ", ") + each.curve.name;
            continue;
        }
        const Shown how = shown(each.curve.name, each.curve.unit);
        std::vector<Point> points;
        for (std::size_t k = 0; k < d.times.size(); ++k) points.push_back({time.factor * d.times[k], how.factor * each.curve.values[k]});
        const std::string label = how.unit.empty() ? "B - A" : fmt::format("B - A [{}]", how.unit);
        Plot plot{.title = each.curve.name + ": B - A", .subtitle = {}, .x = {time.label}, .y = {label}, .height = 300.0};
        plot.series.push_back({"", points, points.size() == 1 ? Mark::dot : Mark::none, Line::solid, "", 1.4});
        text += picture(std::move(plot));
    }
    if (!same.empty()) text += fmt::format("<p>The same in every common row: {}.</p>\n", html(same));
    return text;
}

std::string channels_of_one(const char* which, const std::vector<std::string>& names) {
    if (names.empty()) return "";
    return fmt::format("<p>Only {} has {}.</p>\n", which, html(fmt::format("{}", fmt::join(names, ", "))));
}

/// One record against another: keys of the scenes that differ, key figures side by side, curves of the differences. HTML.
std::string against(const RecordedRun& a, const RecordedRun& b) {
    std::string text = fmt::format("<h3>A: {}, B: {}</h3>\n", html(a.path()), html(b.path())) + keys_that_differ(a, b);
    const RunDifference d = difference(a, b);
    if (d.times.empty()) return text + "<p>The records have no common time, so their rows cannot be compared.</p>\n";
    if (a.times() != b.times())
        text += fmt::format("<p>Compared from {} to {}, at the {} times of A; B is interpolated to these times.</p>\n",
                            time_text(d.times.front()), time_text(d.times.back()), d.times.size());
    return text + side_by_side(d) + channels_of_one("A", d.only_a) + channels_of_one("B", d.only_b) + curves_of_differences(d);
}

/// Curves are drawn by the script.
std::string curves_body(const nlohmann::json& data) {
    std::string text =
        "<div id=\"curves-tools\"><label>Channels <input type=\"search\" id=\"filter\" placeholder=\"filter\"></label> "
        "<button type=\"button\" data-zoom=\"0.5\">zoom in</button> <button type=\"button\" data-zoom=\"2\">zoom out</button> "
        "<button type=\"button\" data-move=\"-0.5\">earlier</button> <button type=\"button\" data-move=\"0.5\">later</button> "
        "<button type=\"button\" id=\"whole\">all</button></div>\n<div id=\"curves-view\"><fieldset "
        "id=\"channels\"><legend>Drawn</legend></fieldset>"
        "<div id=\"panels\"></div></div>\n";
    for (const nlohmann::json& run : data["runs"]) {
        if (run["rows"] != run["shown"])
            text +=
                fmt::format("<p class=\"small\">{}: {} rows, thinned to {} points: each group of rows keeps its minimum and maximum.</p>\n",
                            html(run["label"].get<std::string>()), run["rows"].get<std::size_t>(), run["shown"].get<std::size_t>());
    }
    return text;
}

std::string chain_body(const ChainMotion& motion) {
    return fmt::format(
        "<div id=\"chain-tools\"><button type=\"button\" id=\"play\">play</button> <label>speed <select id=\"speed\"></select></label> "
        "<label>colour <select id=\"colour\"></select></label> <label>time <input type=\"range\" id=\"moment\" min=\"0\" max=\"{}\" "
        "value=\"0\"></label> "
        "<output id=\"moment-text\"></output></div>\n<canvas id=\"chain\" tabindex=\"0\" aria-label=\"The running chain. Arrow keys turn "
        "it, plus and "
        "minus zoom, space plays, P chooses the next pin.\"></canvas>\n<div id=\"legend\"></div><div id=\"pin\" aria-live=\"polite\"></div>"
        "<div id=\"pin-plot\"></div>\n<p class=\"small\">{} of {} recorded states. Drag to turn, wheel to zoom, click a pin to plot it. "
        "Displacements are not magnified; between states the chain is interpolated.</p>\n",
        motion.times.size() - 1, motion.times.size(), motion.recorded);
}

void add_chain(Page& page, const RecordedRun& run) {
    const ChainMotion motion = chain_motion(run, max_states);
    if (motion.times.empty()) {
        page.sections.push_back({"running", "Running chain", "<p>The record has no states that this program can show.</p>\n"});
        return;
    }
    for (const char* script : {"three.min.js", "solids.js", "chain.js"}) page.scripts.push_back(script);
    page.data["motion"] = motion_data(run, motion);
    page.sections.push_back({"running", "Running chain", chain_body(motion)});
    if (page.data["motion"]["pulleys"] && !motion.pin_force.empty())
        page.sections.push_back({"pin-forces", "Pin forces", picture(pin_force_plot(run, motion))});
}

/// "baseline", of several records "baseline, tiny" or "baseline: load.torque 7 N*m, load.torque 8 N*m".
std::string title_of(const std::vector<RecordedRun>& runs) {
    std::string names, settings;
    for (const RecordedRun& run : runs) {
        const std::string name = run.name(), setting = only_difference(runs, run);
        if (&run == &runs.front() || name != runs.front().name()) names += (names.empty() ? "" : ", ") + name;
        if (!setting.empty()) settings += (settings.empty() ? ": " : ", ") + setting;
    }
    return names + settings;
}

}  // namespace

std::string run_page(const std::vector<RecordedRun>& runs, const Measured* measured) {
    Page page;
    page.title = "cvtflow: " + title_of(runs);
    page.scripts = {"dygraph.min.js", "report.js"};
    page.lead = of_all(runs, status_list);
    for (const RecordedRun& run : runs) page.data["runs"].push_back(curve_data(run, bytes_of_curves / runs.size()));
    const Shown time = shown_time(last_time(runs));
    page.data["time"] = {{"u", time.unit}, {"f", time.factor}};
    std::string compared, origins;
    for (std::size_t k = 1; k < runs.size(); ++k) compared += against(runs.front(), runs[k]);
    if (runs.size() > 1) page.sections.push_back({"differences", "Differences", compared});
    page.sections.push_back({"figures", "Key figures", of_all(runs, figures)});
    if (measured != nullptr) page.sections.push_back({"measured", "Measured data", measured_curves(runs, *measured)});
    page.sections.push_back({"simulated", "What was simulated", simulated(runs)});
    page.sections.push_back({"curves", "Curves", curves_body(page.data)});
    add_chain(page, runs.front());
    if (std::ranges::none_of(runs, [](const RecordedRun& run) { return run.group("loss").empty(); }))
        page.sections.push_back(
            {"losses", "Losses", of_all(runs, [](const RecordedRun& run) { return picture(loss_plot(run)) + energies(run); })});
    if (std::ranges::all_of(runs, has_wear)) page.sections.push_back({"wear", "Wear", of_all(runs, wear)});
    page.sections.push_back({"spectra", "Spectra", spectra(runs)});
    for (const RecordedRun& run : runs)
        origins += fmt::format("<h3>{}</h3>\n", html(run.path())) + attribute_table(run.reader().attributes());
    page.sections.push_back({"provenance", "Provenance", origins});
    return text_of(page);
}

}  // namespace cvtflow::tools
