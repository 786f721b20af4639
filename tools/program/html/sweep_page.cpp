#include "tools/program/html/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "engine/base/text.hpp"
#include "tasks/batch/sweep/scalar.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/text/markup.hpp"
#include "tools/program/text/scene_text.hpp"
#include "tools/program/text/text.hpp"
#include "tools/program/view/sweep_view.hpp"

namespace cvtflow::tools {

namespace {

std::string endings(const SweepView& sweep) {
    const std::size_t status = sweep.column("status");
    const auto noted = std::ranges::find(sweep.columns, "notes", &SweepColumn::name);
    std::map<std::string, std::size_t> counts, notes;
    for (const auto& row : sweep.cells) {
        ++counts[row[status]];
        if (noted == sweep.columns.end()) continue;
        for (const std::string& note : engine::words_of(row[static_cast<std::size_t>(noted - sweep.columns.begin())])) ++notes[note];
    }
    std::string items;
    for (const auto& [name, count] : counts)
        items += fmt::format("<li class=\"{}\"><b>{}</b>: {} of {} cases</li>\n", name == "ok" ? "good" : "bad", html(name), count,
                             sweep.cells.size());
    for (const auto& [note, count] : notes)
        items += fmt::format("<li><b>note {}</b>: {} of {} cases</li>\n", html(note), count, sweep.cells.size());
    return fmt::format("<ul class=\"status\">\n{}</ul>\n", items);
}

/// Text columns, whatever their name, have no unit.
Shown how_to_show(const SweepColumn& column) { return column.number ? shown(column.name, column.unit) : Shown{}; }

std::string cases_table(const SweepView& sweep) {
    std::string text = "<div class=\"wide\"><table class=\"sortable\" id=\"cases-table\"><thead><tr>";
    for (const SweepColumn& column : sweep.columns) {
        const std::string unit = how_to_show(column).unit;
        text += fmt::format("<th title=\"{}\">{}{}</th>", html(column.description), html(column.name),
                            unit.empty() ? "" : " [" + html(unit) + "]");
    }
    text += "</tr></thead><tbody>\n";
    for (std::size_t row = 0; row < sweep.cells.size(); ++row) {
        text += "<tr>";
        for (std::size_t c = 0; c < sweep.columns.size(); ++c) {
            const double number = how_to_show(sweep.columns[c]).factor * sweep.number(row, c);
            text += sweep.columns[c].number ? fmt::format("<td class=\"number\" data-value=\"{0:.17g}\">{0:.6g}</td>", number)
                                            : fmt::format("<td>{}</td>", html(sweep.cells[row][c]));
        }
        text += "</tr>\n";
    }
    return text + "</tbody></table></div>\n";
}

nlohmann::json data_of(const SweepView& sweep) {
    nlohmann::json data{{"columns", nlohmann::json::array()}, {"cases", nlohmann::json::array()}};
    for (std::size_t c = 0; c < sweep.columns.size(); ++c) {
        const SweepColumn& column = sweep.columns[c];
        if (!column.number) continue;
        const Shown how = how_to_show(column);
        nlohmann::json values = nlohmann::json::array();
        for (std::size_t row = 0; row < sweep.cells.size(); ++row) values.push_back(how.factor * sweep.number(row, c));
        data["columns"].push_back({{"n", column.name}, {"label", how.label}, {"axis", column.axis}, {"v", std::move(values)}});
    }
    const std::size_t status = sweep.column("status");
    for (const auto& row : sweep.cells) data["cases"].push_back(row[status]);
    return {{"sweep", std::move(data)}};
}

/// Maps of results over two axes; empty where several cases are at one point of these.
std::string maps_over(const SweepView& sweep, const std::string& x, const std::string& y, const std::vector<std::string>& results) {
    std::string text;
    try {
        for (const std::string& result : results) text += "<figure>" + svg(sweep_map(sweep, x, y, result)) + "</figure>\n";
    } catch (const UsageError&) {  // the picture above shows them all
        return "";
    }
    return text;
}

/// Whether a column states what came out, and not how the case was computed.
bool is_result(const SweepColumn& column) {
    static constexpr std::string_view bookkeeping[] = {"case",        "energy_residual", "energy_suspicion",     "steps", "evaluations",
                                                       "transitions", "truncated",       "settling_evaluations", "wall",  "threads"};
    return !column.axis && std::ranges::count(bookkeeping, column.name) == 0;
}

/// Maps over the last axis and the first other axis that differs between cases: contours if the cases form a grid, else coloured points.
std::string maps(const SweepView& sweep) {
    constexpr std::size_t most = 6;
    std::vector<std::string> axes, results;
    for (std::size_t c = 0; c < sweep.columns.size(); ++c) {
        const SweepColumn& column = sweep.columns[c];
        if (!column.number || !sweep.varies(c)) continue;
        if (column.axis) axes.push_back(column.name);
        if (is_result(column) && results.size() < most) results.push_back(column.name);
    }
    for (std::size_t other = 0; other + 1 < axes.size(); ++other) {
        if (std::string text = maps_over(sweep, axes.back(), axes[other], results); !text.empty()) return text;
    }
    return "";
}

/// Measured outputs over the measured key. @throws UsageError if no heading is a column of the sweep, or none is a key
std::string measured_outputs(const SweepView& sweep, const Measured& measured) {
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

/// Detail and keys that all cases share; empty where the table does not say.
std::string simulated(const SweepView& sweep) {
    if (!sweep.scene) return "";
    std::vector<tasks::KeyDifference> keys = differing_keys(*sweep.scene, {});
    std::erase_if(keys, [&](const tasks::KeyDifference& each) {
        return std::ranges::count(sweep.columns, tasks::column_name(each.key->key), &SweepColumn::name) > 0;
    });
    return definition_table({{"detail", html(detail_text(*sweep.scene))}}) + default_differences(keys, "cases");
}

std::string origin(const SweepView& sweep) {
    if (sweep.attributes.empty()) return "<p>A CSV file contains no provenance. The report of the sweep's folder shows it.</p>\n";
    return attribute_table(sweep.attributes);
}

}  // namespace

std::string sweep_page(const SweepView& sweep, const Measured* measured) {
    Page page;
    page.title = "cvtflow: sweep " + sweep.name;
    page.lead = endings(sweep);
    page.data = data_of(sweep);
    page.scripts = {"report.js", "sweep.js"};
    const std::string grid = maps(sweep);
    const std::string description = text_of(sweep.attributes, "description", "");
    page.sections = {
        {"map", "Picture",
         (description.empty() ? "" : "<p>" + html(description) + "</p>\n") +
             "<div id=\"map-tools\"><label>x <select id=\"map-x\"></select></label> <label>y <select id=\"map-y\"></select></label> "
             "<label>colour <select id=\"map-colour\"></select></label></div>\n<figure id=\"map-view\"></figure>\n"
             "<p class=\"small\">Only cases with status ok are shown." +
             (grid.empty() ? " Maps with contours: cvtflow plot SWEEP --x --y --colour." : "") + "</p>\n"},
        {"cases", "Cases", cases_table(sweep)},
        {"provenance", "Provenance", origin(sweep)}};
    if (measured != nullptr)
        page.sections.insert(page.sections.begin() + 1, {"measured", "Measured data", measured_outputs(sweep, *measured)});
    if (!grid.empty()) page.sections.insert(page.sections.begin() + 1, {"maps", "Maps", grid});
    if (const std::string machine = simulated(sweep); !machine.empty())
        page.sections.insert(page.sections.begin() + 1, {"simulated", "What was simulated", machine});
    return text_of(page);
}

}  // namespace cvtflow::tools
