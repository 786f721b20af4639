#include "tools/program/html/run_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tasks/run/run_means.hpp"
#include "tasks/run/saved_start.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tools/program/html/curve_data.hpp"
#include "tools/program/html/difference_body.hpp"
#include "tools/program/html/page.hpp"
#include "tools/program/plot/finite.hpp"
#include "tools/program/text/attribute_text.hpp"
#include "tools/program/text/markup.hpp"
#include "tools/program/text/scene_text.hpp"
#include "tools/program/text/text.hpp"
#include "tools/program/view/labels.hpp"
#include "tools/program/view/run_plots.hpp"
#include "tools/program/view/wear_plots.hpp"

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
    const auto suspicion = run.reader().attribute("energy_suspicion");
    const double* doubt = suspicion ? std::get_if<double>(&suspicion->value) : nullptr;
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

/// A value as text; of a long table its beginning and how many points it has.
std::string brief(const std::string& value) {
    constexpr std::size_t longest = 160;
    const auto end = value.rfind("], [", longest);
    if (value.size() <= longest || end == std::string::npos) return value;
    return fmt::format("{}], … ({} points)", value.substr(0, end), std::count(value.begin(), value.end(), '[') - 1);
}

/// Keys whose values are not the defaults.
std::string differences(const tasks::Scene& scene) {
    const tasks::Scene defaults;
    std::string rows;
    long count = 0;
    for (const tasks::Parameter& parameter : tasks::parameter_table()) {
        const std::string value = tasks::readable_value(parameter, scene), usual = tasks::readable_value(parameter, defaults);
        if (value == usual || parameter.section() == "scene") continue;
        ++count;
        rows += fmt::format("<tr><td><code>{}</code></td><td>{}</td><td>{}</td><td>{}</td></tr>\n", parameter.key, html(brief(value)),
                            html(usual), html(parameter.meaning));
    }
    if (rows.empty()) return "<p>Every key of the scene has its default.</p>\n";
    return fmt::format(
        "<details><summary>{} from defaults</summary><table><thead><tr><th>key</th><th>here</th><th>default</th><th>meaning</th></tr>"
        "</thead><tbody>\n{}</tbody></table></details>\n",
        plural(count, "difference"), rows);
}

/// Mean power that flows into a shaft from outside [W]; NaN if the record does not contain it.
double power_into(const RecordedRun& run, int shaft) {
    std::vector<double> torque, speed;
    for (const engine::ChannelInfo& channel : run.reader().channels()) {
        if (channel.name == fmt::format("shaft_{}/torque", shaft)) torque = run.reader().channel(channel.name);
        if (channel.name == fmt::format("shaft_{}/speed", shaft)) speed = run.reader().channel(channel.name);
    }
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

std::string simulated(const RecordedRun& run) {
    const auto& times = run.times();
    std::vector<std::pair<std::string, std::string>> rows{{"record", html(run.path())}, {"scene", html(attribute(run, "scene"))}};
    if (run.scene()) rows.insert(rows.end(), {{"", html(run.scene()->description)}, {"detail", html(detail_text(*run.scene()))}});
    rows.push_back({"conditions", html(run.conditions())});
    if (const std::string drive = drive_text(run); !drive.empty()) rows.push_back({"power", html(drive)});
    rows.push_back({"time", fmt::format("{} to {}, {} rows, {} states", time_text(times.front()), time_text(times.back()),
                                        count_text(static_cast<long>(times.size())), run.reader().state_times().size())});
    return definition_table(rows) + (run.scene() ? differences(*run.scene()) : "<p>This program cannot read the record's scene.</p>\n");
}

/// Mean of all rows, of the last fifth, least and largest.
std::string figures(const RecordedRun& run) {
    std::string rows;
    for (const Curve& curve : run.overview()) {
        const std::span<const double> values = curve.values;
        const FiniteFigures all(values), last(values.subspan(4 * values.size() / 5));
        const Shown how = shown(curve.name, curve.unit);
        rows += fmt::format("<tr data-channel=\"{0}\"><td title=\"{1}\">{0}</td><td>{2}</td>", html(curve.name), html(curve.description),
                            html(how.unit));
        for (const double number : {all.mean, last.mean, all.least, all.largest}) rows += number_cell(how.factor * number, "{:.6g}");
        rows += "</tr>\n";
    }
    return fmt::format(
        "<table class=\"sortable\"><caption>{}</caption><thead><tr><th>channel</th><th>unit</th><th>mean</th><th>mean of the last "
        "fifth</th><th>least</th><th>largest</th></tr></thead><tbody>\n{}</tbody></table>\n",
        html(run.path()), rows);
}

/// What a channel of energies so far gained over the record, by kind. Empty if the record has none.
std::string energies(const RecordedRun& run) {
    std::string rows;
    for (const char* group : {"work", "dissipated", "hydraulics"}) {
        for (const Curve& curve : run.group(group)) {
            const double gained = curve.values.back() - curve.values.front();
            if (curve.unit != "J" || gained == 0.0) continue;
            rows += fmt::format("<tr><td>{}</td><td>{}</td><td class=\"number\" data-value=\"{:.9g}\">{:.6g}</td></tr>\n", html(curve.name),
                                html(curve.description), gained, gained);
        }
    }
    if (rows.empty()) return "";
    return "<table class=\"sortable\"><caption>Energies over the record</caption><thead><tr><th>channel</th><th>meaning</th><th>J</th></tr>"
           "</thead><tbody>\n" +
           rows + "</tbody></table>\n";
}

std::string picture(Plot plot) {
    for (Series& series : plot.series) series.points = thinned(series.points, columns_of_picture);
    return "<figure>" + svg(plot) + "</figure>\n";
}

std::string provenance(const RecordedRun& run) {
    std::vector<std::pair<std::string, std::string>> rows;
    std::string texts;
    for (const engine::Attribute& each : run.reader().attributes()) {
        if (each.name == tasks::step_taken_attribute) continue;  // beside "step"
        const std::string value = each.name == "step" ? step_text(run.reader().attributes()) : value_text(each);
        if (value.find('\n') == std::string::npos)
            rows.emplace_back(each.name, html(value));
        else
            texts += fmt::format("<details><summary>{}</summary><pre>{}</pre></details>\n", html(each.name), html(value));
    }
    return fmt::format("<h3>{}</h3>\n", html(run.path())) + definition_table(rows) + texts;
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
    page.data["motion"] = motion_data(motion);
    page.sections.push_back({"running", "Running chain", chain_body(motion)});
    if (motion.pulleys && !motion.force.empty())
        page.sections.push_back({"tips", "Tip forces", picture(tip_force_plot(motion, run.conditions()))});
}

}  // namespace

std::string run_page(const std::vector<RecordedRun>& runs) {
    Page page;
    page.title = "cvtflow: " + attribute(runs.front(), "scene");
    for (std::size_t k = 1; k < runs.size(); ++k) page.title += ", " + attribute(runs[k], "scene");
    page.scripts = {"dygraph.min.js", "report.js"};
    page.lead = of_all(runs, status_list);
    for (const RecordedRun& run : runs) page.data["runs"].push_back(curve_data(run, bytes_of_curves / runs.size()));
    page.sections = {{"simulated", "What was simulated", of_all(runs, simulated)},
                     {"figures", "Key figures", of_all(runs, figures)},
                     {"curves", "Curves", curves_body(page.data)}};
    if (runs.size() > 1) page.sections.insert(page.sections.begin() + 2, {"differences", "Differences", difference_body(runs)});
    add_chain(page, runs.front());
    page.sections.push_back({"spectra", "Spectra", spectra(runs)});
    const auto has_losses = [](const RecordedRun& run) { return !run.group("loss").empty(); };
    if (std::all_of(runs.begin(), runs.end(), has_losses))
        page.sections.push_back(
            {"losses", "Losses", of_all(runs, [](const RecordedRun& run) { return picture(loss_plot(run, false)) + energies(run); })});
    if (std::all_of(runs.begin(), runs.end(), has_wear)) page.sections.push_back({"wear", "Wear", of_all(runs, wear)});
    std::string origins;
    for (const RecordedRun& run : runs) origins += provenance(run);
    page.sections.push_back({"provenance", "Provenance", origins});
    return text_of(page);
}

}  // namespace cvtflow::tools
