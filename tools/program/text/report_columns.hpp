#pragma once
/// Reports: columns, each stated once, as a table on the terminal, as CSV and as JSON; JSON files with provenance.

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

inline constexpr int usual_digits = 9, all_digits = 0;  ///< all: as many as it takes to read the same number back

template <class Row>
struct ReportColumn {
    std::string key;                                               ///< name in CSV and JSON; empty: on the terminal only
    std::string heading;                                           ///< heading on the terminal; empty: in files only
    std::function<nlohmann::ordered_json(const Row&)> value = {};  ///< number, text or truth value; null: unknown
    std::function<std::string(const Row&)> cell = {};              ///< text on the terminal
    Align align = Align::right;
    int digits = usual_digits;  ///< digits of real numbers in CSV
    bool quoted = false;        ///< texts in CSV always, not only where they must be
};

/// "" for null and numbers that are not finite, 1 or 0 for truth values; texts as tasks::csv_cell writes them.
[[nodiscard]] std::string csv_cell(const nlohmann::ordered_json& value, int digits = usual_digits, bool quoted = false);

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
    for (const Row& row : rows)
        line([&](const ReportColumn<Row>& column) { return csv_cell(column.value(row), column.digits, column.quoted); });
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

[[nodiscard]] nlohmann::ordered_json provenance_json();
/// Text of a JSON file: indented; numbers that are not finite are null.
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& json);

}  // namespace cvtflow::tools
