#include "tools/program/text/sizing_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "tools/program/text/report_columns.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

using tasks::SizedPoint;

/// A row of the table: its name and key, SI unit and unit of the table, and its value in SI.
struct SizedRow {
    const char *label, *key, *si, *unit;
    double factor;  ///< factor from SI to the unit of the table
    double (*value)(const SizedPoint& at);
};

constexpr double per_rpm = 30.0 / std::numbers::pi;
constexpr SizedRow sized_rows[] = {
    {"time", "time", "s", "s", 1.0, [](const SizedPoint& at) { return at.time; }},
    {"ratio", "ratio", "1", "", 1.0, [](const SizedPoint& at) { return at.ratio; }},
    {"speed of shaft 1", "speed", "rad/s", "rpm", per_rpm, [](const SizedPoint& at) { return at.speed; }},
    {"load of shaft 2", "load", "N*m", "N*m", 1.0, [](const SizedPoint& at) { return at.load; }},
    {"torque limit of shaft 2", "limit", "N*m", "N*m", 1.0, [](const SizedPoint& at) { return at.limit; }},
    {"safety factor", "safety", "1", "", 1.0, [](const SizedPoint& at) { return at.factor(); }},
    {"S_2", "driven_clamping", "N", "kN", 1e-3, [](const SizedPoint& at) { return at.clamping[1]; }},
    {"  of the piston", "driven_piston", "N", "kN", 1e-3, [](const SizedPoint& at) { return at.piston[1]; }},
    {"  pressure", "driven_pressure", "Pa", "bar", 1e-5, [](const SizedPoint& at) { return at.pressure[1]; }},
    {"S_1 that holds the ratio", "driving_clamping", "N", "kN", 1e-3, [](const SizedPoint& at) { return at.clamping[0]; }},
    {"  of the piston", "driving_piston", "N", "kN", 1e-3, [](const SizedPoint& at) { return at.piston[0]; }},
    {"  pressure", "driving_pressure", "Pa", "bar", 1e-5, [](const SizedPoint& at) { return at.pressure[0]; }},
    {"shift, d ln(ratio)/dt", "shift", "1/s", "1/s", 1.0, [](const SizedPoint& at) { return at.shift; }},
    {"S_1 while it shifts so", "shifting_clamping", "N", "kN", 1e-3, [](const SizedPoint& at) { return at.shifting; }},
    {"  beside clamping.driving", "correction", "N", "kN", 1e-3, [](const SizedPoint& at) { return at.correction; }}};

std::string cell(double value) { return std::isfinite(value) ? fmt::format("{:.4g}", value) : "-"; }

/// Sentences about pressures and forces beyond the machine at a point.
std::string warnings(const model::Parameters& p, bool of_tables, const SizedPoint& at) {
    std::string text;
    const auto warn = [&](const std::string& sentence) { text += field("", at.reason + ": " + sentence); };
    if (!at.objection.empty()) warn(at.objection);
    for (std::size_t k = 0; k < 2; ++k)
        if (at.pressure[k] > p.hydraulics.relief_pressure * (1.0 + 1e-9))
            warn(fmt::format("{:.4g} bar on shaft {} are above hydraulics.relief_pressure, {:.4g} bar: a larger hydraulics.{}_area",
                             1e-5 * at.pressure[k], k + 1, 1e-5 * p.hydraulics.relief_pressure, k == 0 ? "driving" : "driven"));
    const bool acts = p.hydraulics.mode != model::HydraulicMode::none;
    for (const std::size_t k : {1U, 0U})
        if (at.clamping[k] < at.least[k] || (k == 1 && at.decided == "rotating oil"))
            warn(fmt::format("S_{} is at least {:.4g} kN: rotating oil and spring alone press so{}", k + 1, 1e-3 * at.least[k],
                             acts ? "" : " on the pistons of [hydraulics]"));
    if (const double least = acts ? std::max(0.0, at.least[0]) : 0.0; at.shift != 0.0 && at.shifting < least)
        warn(fmt::format("S_1 is at least {:.4g} kN: the ratio shifts more slowly than its target", 1e-3 * least));
    if (of_tables && p.control.enabled && p.control.quantity == model::ControlledQuantity::ratio &&
        std::abs(at.correction) > p.control.authority)
        warn(fmt::format("control has to add {:.4g} kN to clamping.driving, its authority is {:.4g} kN: change one of both",
                         1e-3 * at.correction, 1e-3 * p.control.authority));
    return text;
}

}  // namespace

std::string sizing_lines(const tasks::Scene& scene, const tasks::Sizing& sizing) {
    const model::Parameters& p = scene.parameters;
    if (p.detail.pulleys == model::PulleyDetail::absent || p.start.layout != model::StartLayout::belt) return "";
    if (sizing.points.empty()) return sizing.objection.empty() ? "" : field("not sized", sizing.objection);
    std::string text;
    const SizedPoint& least = sizing.points.front();
    if (sizing.of_tables && std::isfinite(least.factor())) {
        text +=
            field("torque limit",
                  fmt::format("{:.4g} N*m on the driven pulley (2 mu S_2 r_2/cos(beta)); load{} {:.4g} N*m: safety factor {:.3g}",
                              least.limit, p.drag.driven == model::ShaftDrag{} ? "" : " and drag", std::abs(least.load), least.factor()));
        if (least.factor() < 1.0)
            text += field("", "the load exceeds the limit: the chain slips; raise clamping.driven or lower load.torque");
    }
    std::vector<Table::Column> columns{{"sizing"}, {"unit"}};
    for (const SizedPoint& at : sizing.points) columns.push_back({at.reason, Align::right});
    Table table(std::move(columns));
    const bool shifts = std::ranges::any_of(sizing.points, [](const SizedPoint& at) { return at.shift != 0.0; });
    for (const SizedRow& row : sized_rows) {
        const std::string_view key = row.key;
        if ((key == "shift" || key == "shifting_clamping") && !shifts) continue;
        if ((key == "time" || key == "correction") && !sizing.of_tables) continue;
        std::vector<std::string> cells{row.label, row.unit};
        for (const SizedPoint& at : sizing.points) cells.push_back(cell(row.factor * row.value(at)));
        table.add(std::move(cells));
        if (key != "driven_clamping") continue;
        std::vector<std::string> keys{"  decided by", ""};
        for (const SizedPoint& at : sizing.points) keys.push_back(at.decided);
        table.add(std::move(keys));
    }
    text += table.text(2);
    for (const SizedPoint& at : sizing.points) text += warnings(p, sizing.of_tables, at);
    return text;
}

std::string validity_lines(const std::vector<std::string>& outside) {
    if (outside.empty()) return field("validity", "inside the ranges in which errors are known (guide: Validity)");
    std::string text;
    for (const std::string& sentence : outside) text += field(text.empty() ? "outside validity" : "", sentence);
    return text;
}

std::string sizing_json(const tasks::Scene& scene, const tasks::Sizing& sizing, const std::vector<std::string>& outside) {
    auto points = nlohmann::ordered_json::array();
    auto units = nlohmann::ordered_json::object();
    for (const SizedPoint& at : sizing.points) {
        nlohmann::ordered_json& point = points.emplace_back(nlohmann::ordered_json{{"reason", at.reason}, {"decided_by", at.decided}});
        for (const SizedRow& row : sized_rows) point[row.key] = row.value(at);
        if (!at.objection.empty()) point["objection"] = at.objection;
    }
    for (const SizedRow& row : sized_rows) units[row.key] = row.si;
    return json_text(
        {{"scene", scene.name}, {"objection", sizing.objection}, {"units", units}, {"points", points}, {"outside_validity", outside}});
}

}  // namespace cvtflow::tools
