#include "tools/program/view/labels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "tasks/scene/units.hpp"

namespace cvtflow::tools {

namespace {

/// Quantities that are shown in per cent.
bool in_percent(const std::string& name, const std::string& unit) {
    if (!unit.empty() && unit != "1") return false;
    const std::string last = name.substr(name.rfind('/') + 1);
    return last.find("slip") != std::string::npos || last.starts_with("efficiency") || last == "creep";
}

/// "N*m" -> "N·m".
std::string with_dots(std::string unit) {
    for (auto at = unit.find('*'); at != std::string::npos; at = unit.find('*')) unit.replace(at, 1, "·");
    return unit;
}

/// "slip_mean" -> "mean slip", "tight_tension" -> "tight tension".
std::string words_of(std::string name) {
    static constexpr std::array reductions{"mean", "median", "max", "min", "final", "rms"};
    for (const char* reduction : reductions) {
        const std::string end = std::string("_") + reduction;
        if (name.ends_with(end)) name = fmt::format("{} {}", reduction, name.substr(0, name.size() - end.size()));
    }
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
}

}  // namespace

Shown shown(const std::string& name, const std::string& unit) {
    if (in_percent(name, unit)) return {words_of(name) + " [%]", 100.0, "%"};
    if (unit.empty() || unit == "1") return {words_of(name), 1.0, ""};
    return {fmt::format("{} [{}]", words_of(name), with_dots(unit)), 1.0, unit};
}

std::string label_of_unit(const std::string& unit) {
    const auto parsed = tasks::parse_quantity("1 " + unit);
    const auto* quantity = std::get_if<tasks::Quantity>(&parsed);
    std::string name(quantity == nullptr ? "" : tasks::dimension_name(quantity->dimension));
    if (const auto article = name.find(' '); article != std::string::npos) name = name.substr(article + 1);
    return fmt::format("{}[{}]", name.empty() ? "" : name + " ", with_dots(unit));
}

}  // namespace cvtflow::tools
