#pragma once
/// Tables as tests compare them.

#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "tasks/scene/csv.hpp"

namespace cvtflow::test {

using CsvRow = std::map<std::string, std::string>;  ///< cells by the names of their columns

/// Complete rows of a text with a heading.
[[nodiscard]] inline std::vector<CsvRow> csv_rows(const std::string& text) {
    const auto lines = tasks::csv_lines(text);
    std::vector<CsvRow> rows;
    for (std::size_t k = 1; k < lines.size(); ++k) {
        if (lines[k].size() != lines[0].size()) continue;
        rows.emplace_back();
        for (std::size_t column = 0; column < lines[0].size(); ++column) rows.back()[lines[0][column]] = lines[k][column];
    }
    return rows;
}
/// Complete rows of a file of the sources.
[[nodiscard]] inline std::vector<CsvRow> committed_rows(const std::string& name) {
    std::ifstream file(CVTFLOW_SOURCE_DIR "/" + name);
    return csv_rows(std::string((std::istreambuf_iterator<char>(file)), {}));
}

}  // namespace cvtflow::test
