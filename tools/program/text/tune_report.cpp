#include "tools/program/text/tune_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/program/drawing.hpp"
#include "tools/program/text/report_columns.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

constexpr std::size_t shown_untried = 3, longest_reason = 160;
constexpr double busy = 0.2;  ///< spread of costs from which on a machine is called busy [1]

std::string percent_cell(double share) { return std::isfinite(share) ? fmt::format("{:.2g}", 100.0 * share) : "-"; }

/// The first line of a reason, and not all of a long list.
std::string brief(const std::string& reason) {
    const std::string line = reason.substr(0, reason.find('\n'));
    return line.size() <= longest_reason ? line : line.substr(0, line.rfind(',', longest_reason)) + ", …";
}

std::string detail_cell(const tasks::TuneChoice& choice) { return choice.detail.empty() ? "own" : choice.detail; }

std::string step_cell(const tasks::TunedChoice& choice) {
    if (choice.choice.share == 1.0 && choice.choice.step == 0.0) return "auto";
    return choice.step > 0.0 ? time_text(choice.step) : fmt::format("auto/{:g}", 1.0 / choice.choice.share);
}

using Choice = tasks::TunedChoice;

/// Columns of the terminal's table and of the CSV.
std::vector<ReportColumn<Choice>> choice_columns(const std::vector<std::string>& outputs) {
    constexpr int few = 6;
    const auto text = [](const char* key, const char* heading, bool quoted, std::string (*of)(const Choice&)) -> ReportColumn<Choice> {
        return {key, heading, of, of, Align::left, usual_digits, quoted};
    };
    std::vector<ReportColumn<Choice>> columns{
        {"detail", "detail", [](const Choice& c) { return c.choice.detail; }, [](const Choice& c) { return detail_cell(c.choice); },
         Align::left},
        text("method", "method", false, [](const Choice& c) { return c.choice.method; }),
        {"share", "", [](const Choice& c) { return c.choice.share; }, {}, Align::right, few},
        {"step_s", "step", [](const Choice& c) { return c.step; }, step_cell, Align::right, few},
        {"seconds_per_second", "s/s", [](const Choice& c) { return c.seconds; },
         [](const Choice& c) { return fmt::format("{:.3g}", c.seconds); }, Align::right, few},
        {"spread", "spread %", [](const Choice& c) { return c.spread; },
         [](const Choice& c) { return fmt::format("{:.0f}", 100.0 * c.spread); }, Align::right, 3},
        {"work_per_second", "", [](const Choice& c) { return c.work; }, {}, Align::right, few},
    };
    for (std::size_t i = 0; i < outputs.size(); ++i)
        columns.push_back({csv_cell("error " + outputs[i], 0, true), outputs[i] + " %",
                           [i](const Choice& c) { return c.tried ? nlohmann::ordered_json(c.errors[i]) : nlohmann::ordered_json(); },
                           [i](const Choice& c) { return c.tried ? percent_cell(c.errors[i]) : ""; }, Align::right, few});
    columns.push_back(text("worst", "", true, [](const Choice& c) { return c.worst; }));
    columns.push_back(
        {"front", "front", [](const Choice& c) { return c.front; }, [](const Choice& c) { return c.front ? "*" : ""; }, Align::left});
    columns.push_back(text("standing", "standing", true, [](const Choice& c) { return c.outcome; }));
    return columns;
}

}  // namespace

std::string tune_text(const tasks::TuneResult& result) {
    double spread = 0.0;
    std::size_t untried = 0;
    std::vector<Choice> shown;
    for (const Choice& c : result.choices) {
        spread = std::max(spread, c.spread);
        if (c.tried || ++untried <= shown_untried) shown.push_back(c);
    }
    std::string text = fmt::format("{}: accuracy {:g} %, at {}\n{}", result.scene, 100.0 * result.accuracy,
                                   plural(static_cast<long>(result.points.size()), "operating point"),
                                   report_table(choice_columns(result.outputs), shown));
    if (untried > shown_untried) text += fmt::format("  … and {} untried ones (--csv, --json)\n", untried - shown_untried);
    for (std::size_t i = 0; i < result.points.size(); ++i)
        text += field(i == 0 ? "against" : "", result.points[i] + ": " + result.references[i]);
    for (std::size_t i = 0; i < result.left_out.size(); ++i) text += field(i == 0 ? "left out" : "", brief(result.left_out[i]));
    if (spread > busy)
        text += field(
            "busy machine",
            fmt::format("repeated measurements of a cost differ by up to {:.0f} %; choices within that are ranked by number of evaluations",
                        100.0 * spread));
    const std::string margin = fmt::format("errors times {:g} within the target", result.margin);
    text += field("chosen", result.chosen ? fmt::format("{}: {:.3g} s/s, {}", result.choices[*result.chosen].choice.text(),
                                                        result.choices[*result.chosen].seconds, margin)
                                          : "none: " + result.why_none());
    if (result.chosen) text += field("one more digit", result.next_digit);
    return text + field("took", clock_text(result.wall));
}

std::string tune_csv(const tasks::TuneResult& result) { return report_csv(choice_columns(result.outputs), result.choices); }

nlohmann::ordered_json tune_json(const tasks::TuneResult& result, const std::vector<tasks::UnseenPoint>& unseen) {
    using nlohmann::ordered_json;
    auto rows = ordered_json::array(), points = ordered_json::array();
    for (const tasks::TunedChoice& c : result.choices) {
        rows.push_back({{"detail", c.choice.detail},
                        {"method", c.choice.method},
                        {"share", c.choice.share},
                        {"step", c.step},
                        {"seconds_per_second", c.seconds},
                        {"spread", c.spread},
                        {"work_per_second", c.work},
                        {"tried", c.tried},
                        {"errors", c.errors},
                        {"worst", c.worst},
                        {"front", c.front},
                        {"standing", c.outcome}});
    }
    for (const tasks::UnseenPoint& point : unseen)
        points.push_back({{"point", point.name}, {"errors", point.errors}, {"remark", point.remark}});
    return ordered_json{{"scene", result.scene},
                        {"provenance", provenance_json()},
                        {"accuracy", result.accuracy},
                        {"margin", result.margin},
                        {"outputs", result.outputs},
                        {"points", result.points},
                        {"references", result.references},
                        {"left_out", result.left_out},
                        {"chosen", result.chosen ? ordered_json(*result.chosen) : ordered_json()},
                        {"budget_used_up_by", result.used_up_by.empty() ? ordered_json() : ordered_json(result.used_up_by)},
                        {"choices", rows},
                        {"unseen", points},
                        {"next_digit", result.next_digit},
                        {"wall", result.wall}};
}

std::string tune_picture(const nlohmann::ordered_json& json, const std::string& mark) { return drawn({{"mark", mark}, {"tuning", json}}); }

std::string unseen_text(const tasks::TuneResult& result, const std::vector<tasks::UnseenPoint>& unseen) {
    std::vector<Table::Column> columns{{"point not used by tuning"}};
    for (const std::string& output : result.outputs) columns.push_back({output + " %", Align::right});
    columns.push_back({""});
    Table table(columns);
    for (const tasks::UnseenPoint& point : unseen) {
        std::vector<std::string> cells{point.name};
        for (std::size_t i = 0; i < result.outputs.size(); ++i) cells.push_back(point.errors.empty() ? "" : percent_cell(point.errors[i]));
        cells.push_back(!point.remark.empty() ? point.remark : tasks::largest(point.errors) <= result.accuracy ? "" : "misses the target");
        table.add(cells);
    }
    return table.text(2);
}

}  // namespace cvtflow::tools
