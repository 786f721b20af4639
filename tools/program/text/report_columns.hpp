#pragma once
/// Columns of a report, each stated once: as a table on the terminal, as CSV and as JSON.

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tasks/scene/csv.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

template <class Row>
struct ReportColumn {
    std::string key;                                               ///< in CSV and JSON; empty: on the terminal only
    std::string heading;                                           ///< on the terminal; empty: in files only
    std::function<nlohmann::ordered_json(const Row&)> value = {};  ///< number, text or truth value; null: unknown
    std::function<std::string(const Row&)> cell = {};              ///< on the terminal
    Align align = Align::right;
};

/// "" for null and numbers that are not finite, 1 or 0 for truth values, nine digits; texts as tasks::csv_cell writes them.
[[nodiscard]] inline std::string csv_cell(const nlohmann::ordered_json& value) {
    if (value.is_boolean()) return value.get<bool>() ? "1" : "0";
    if (value.is_number_float()) return std::isfinite(value.get<double>()) ? fmt::format("{:.9g}", value.get<double>()) : "";
    if (value.is_null()) return "";
    if (!value.is_string()) return value.dump();
    return tasks::csv_cell(value.get<std::string>(), true);
}

template <class Row>
[[nodiscard]] std::string report_table(const std::vector<ReportColumn<Row>>& columns, const std::vector<Row>& rows, int indent = 2) {
    std::vector<Table::Column> headings;
    for (const ReportColumn<Row>& column : columns) {
        if (!column.heading.empty()) headings.push_back({column.heading, column.align});
    }
    Table table(headings);
    for (const Row& row : rows) {
        std::vector<std::string> cells;
        for (const ReportColumn<Row>& column : columns) {
            if (!column.heading.empty()) cells.push_back(column.cell(row));
        }
        table.add(cells);
    }
    return table.text(indent);
}

template <class Row>
[[nodiscard]] std::string report_csv(const std::vector<ReportColumn<Row>>& columns, const std::vector<Row>& rows) {
    std::string text;
    const auto line = [&](const auto& cell) {
        bool first = true;
        for (const ReportColumn<Row>& column : columns) {
            if (column.key.empty()) continue;
            text += (first ? "" : ",") + cell(column);
            first = false;
        }
        text += "\n";
    };
    line([](const ReportColumn<Row>& column) { return column.key; });
    for (const Row& row : rows) line([&](const ReportColumn<Row>& column) { return csv_cell(column.value(row)); });
    return text;
}

template <class Row>
[[nodiscard]] nlohmann::ordered_json report_json(const std::vector<ReportColumn<Row>>& columns, const std::vector<Row>& rows) {
    auto json = nlohmann::ordered_json::array();
    for (const Row& row : rows) {
        nlohmann::ordered_json& object = json.emplace_back(nlohmann::ordered_json::object());
        for (const ReportColumn<Row>& column : columns) {
            if (!column.key.empty()) object[column.key] = column.value(row);
        }
    }
    return json;
}

}  // namespace cvtflow::tools
