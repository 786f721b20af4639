#include "tools/program/text/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/text.hpp"
#include "engine/executor/catalogue.hpp"
#include "engine/record/run/schema.hpp"
#include "tasks/scene/csv.hpp"
#include "tasks/scene/units.hpp"
#include "tools/program/text/report_columns.hpp"

namespace cvtflow::tools {

namespace {

std::string on_one_line(const std::string& text) {
    std::string shown = engine::visible(text);
    std::replace(shown.begin(), shown.end(), '\n', ' ');
    return shown;
}

/// "N*m" -> "N·m".
std::string with_dots(std::string unit) {
    for (auto at = unit.find('*'); at != std::string::npos; at = unit.find('*')) unit.replace(at, 1, "·");
    return unit;
}

/// "slip_mean" -> "mean slip", "tight_tension" -> "tight tension".
std::string words_of(std::string name) {
    for (const char* reduction : {"mean", "median", "max", "min", "final", "rms"}) {
        const std::string end = std::string("_") + reduction;
        if (name.ends_with(end)) name = fmt::format("{} {}", reduction, name.substr(0, name.size() - end.size()));
    }
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
}

bool si_units = false;  ///< set once, by the command line

}  // namespace

void show_si() noexcept { si_units = true; }

std::string time_text(double seconds) {
    const double magnitude = std::abs(seconds);
    if (magnitude == 0.0 || magnitude >= 0.99995) return fmt::format("{:.4g} s", seconds);
    for (const auto& [size, unit] : {std::pair{1e-3, "ms"}, {1e-6, "us"}, {1e-9, "ns"}})
        if (magnitude >= 0.99995 * size) return fmt::format("{:.4g} {}", seconds / size, unit);
    return fmt::format("{:.4g} s", seconds);
}

std::string clock_text(double seconds) {
    if (!std::isfinite(seconds) || seconds > 1e9) return "?";
    const long whole = std::lround(std::max(0.0, seconds));
    const long hours = whole / 3600;
    if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, whole / 60 % 60, whole % 60);
    return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

std::string duration_text(double seconds) {
    if (!(seconds < 60.0)) return clock_text(seconds);
    return seconds < 0.1 ? "less than 0.1 s" : fmt::format("{:.2g} s", seconds);
}

std::string size_text(double bytes) {
    if (bytes < 1e3) return fmt::format("{:.0f} B", bytes);
    if (bytes < 1e6) return fmt::format("{:.1f} kB", 1e-3 * bytes);
    return bytes < 1e9 ? fmt::format("{:.1f} MB", 1e-6 * bytes) : fmt::format("{:.1f} GB", 1e-9 * bytes);
}

std::string count_text(long count) {
    std::string digits = std::to_string(std::abs(count));
    for (int at = static_cast<int>(digits.size()) - 3; at > 0; at -= 3) digits.insert(static_cast<std::size_t>(at), " ");
    return (count < 0 ? "-" : "") + digits;
}

std::string plural(long count, const std::string& noun) { return fmt::format("{} {}{}", count_text(count), noun, count == 1 ? "" : "s"); }

void Table::add(std::vector<std::string> cells) {
    cells.resize(columns_.size());
    for (std::string& cell : cells) cell = on_one_line(cell);
    rows_.push_back(std::move(cells));
}

std::string Table::text(int indent) const {
    std::vector<std::size_t> width;
    for (const Column& column : columns_) width.push_back(column.heading.size());
    for (const auto& row : rows_) {
        for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], row[i].size());
    }
    std::string text;
    const auto line = [&](const auto& cell) {
        std::string made(static_cast<std::size_t>(indent), ' ');
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            const std::string_view gap = i == 0 ? "" : "  ";
            made += columns_[i].align == Align::right ? fmt::format("{}{:>{}}", gap, cell(i), width[i])
                                                      : fmt::format("{}{:<{}}", gap, cell(i), width[i]);
        }
        text += made.substr(0, made.find_last_not_of(' ') + 1) + "\n";
    };
    line([&](std::size_t i) -> const std::string& { return columns_[i].heading; });
    line([&](std::size_t i) { return std::string(width[i], '-'); });
    for (const auto& row : rows_) line([&](std::size_t i) -> const std::string& { return row[i]; });
    return text;
}

std::string field(const std::string& label, const std::string& value) {
    return fmt::format("  {:<19} {}\n", label, engine::visible(value));
}

std::string executor_table() {
    Table table({{"executor"}, {"threads"}, {"description"}});
    for (const engine::ExecutorRow& row : engine::executors())
        table.add({std::string(row.name), row.parallel ? "many" : "one", std::string(row.description)});
    return table.text();
}

std::string absent_executor_text() {
    std::string absent;
    for (const engine::ExecutorRow& row : engine::absent_executors())
        absent += fmt::format("  {:<12}{}\n  {:<12}requires {}\n", row.name, row.description, "", row.needs);
    return absent.empty() ? "" : "\nNot in this program:\n" + absent;
}

Shown shown(const std::string& name, const std::string& unit) {
    const tasks::DisplayUnit how = si_units ? tasks::DisplayUnit{unit, 1.0} : tasks::display_unit(name, unit);
    if (how.unit.empty() || how.unit == "1") return {words_of(name), 1.0, ""};
    const std::string symbol(how.unit);
    return {fmt::format("{} [{}]", words_of(name), with_dots(symbol)), how.factor, symbol};
}

std::string csv_cell(const nlohmann::ordered_json& value, int digits, bool quoted) {
    if (value.is_boolean()) return value.get<bool>() ? "1" : "0";
    if (value.is_null()) return "";
    if (value.is_string()) return tasks::csv_cell(value.get<std::string>(), true, quoted);
    if (!value.is_number_float()) return value.dump();
    const double number = value.get<double>();
    if (!std::isfinite(number)) return "";
    return digits == all_digits ? fmt::format("{}", number) : fmt::format("{:.{}g}", number, digits);
}

nlohmann::ordered_json provenance_json() {
    nlohmann::ordered_json json;
    for (const engine::Attribute& each : engine::attributes_of(engine::current_provenance()))
        std::visit([&](const auto& value) { json[each.name == "program_version" ? "version" : each.name] = value; }, each.value);
    json.erase("hdf5_version");
    return json;
}

std::string json_text(const nlohmann::ordered_json& json) {
    return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace cvtflow::tools
