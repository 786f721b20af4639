#pragma once
/// Numbers, units and tables for people. Pictures, pages and tables show names without underscores and the units of tasks::display_unit;
/// files of numbers (records, tables of sweeps, exported CSV) contain SI units, and so shares of 1.

#include <string>
#include <vector>

namespace cvtflow::tools {

/// "2.25 ms", "-10 us", "0 s": four digits.
[[nodiscard]] std::string time_text(double seconds);
/// Wall time: "0:07", "12:30", "3:05:00".
[[nodiscard]] std::string clock_text(double seconds);
/// Estimated wall time: "0.3 s", "12 s"; from a minute on as above.
[[nodiscard]] std::string duration_text(double seconds);
/// "512 B", "1.2 MB".
[[nodiscard]] std::string size_text(double bytes);
/// "1 234 567".
[[nodiscard]] std::string count_text(long count);
/// "12 steps", "1 step".
[[nodiscard]] std::string plural(long count, const std::string& noun);

enum class Align { left, right };

/// Rows of cells under a heading, as wide as their longest cell.
class Table {
public:
    struct Column {
        std::string heading;
        Align align = Align::left;
    };

    explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}
    void add(std::vector<std::string> cells);
    /// Lines with a line break each. @param indent spaces before each line
    [[nodiscard]] std::string text(int indent = 0) const;

private:
    std::vector<Column> columns_;
    std::vector<std::vector<std::string>> rows_;
};

/// "  label               value\n", as in the summary of a run.
[[nodiscard]] std::string field(const std::string& label, const std::string& value);

/// A row per executor of this program.
[[nodiscard]] std::string executor_table();
/// Executors that this build lacks, and their requirements; empty if none is missing.
[[nodiscard]] std::string absent_executor_text();

/// Label and unit that show a quantity.
struct Shown {
    std::string label;    ///< "slip [%]", "tight tension [N]"
    double factor = 1.0;  ///< factor from the unit of the record to that of the label
    std::string unit;     ///< unit of the label: "%", "N"; empty: none
};

/// Pictures, pages and tables of this process show SI units from now on. Called while the command line is parsed.
void show_si() noexcept;
inline constexpr const char* si_meaning = "Show SI units (default: bar, l/min, rpm, kN, mm, %)";

/// A channel or a column of a sweep. @param unit SI unit; "1" or empty: none
[[nodiscard]] Shown shown(const std::string& name, const std::string& unit);

}  // namespace cvtflow::tools
