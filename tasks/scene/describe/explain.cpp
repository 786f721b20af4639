#include <string>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml/unit_hints.hpp"
#include "tasks/scene/toml/units.hpp"

namespace cvtflow::tasks {
namespace {

std::string range_text(const Parameter& parameter) {
    const std::string unit = parameter.unit == "1" ? "" : fmt::format(" {}", parameter.unit);
    if (parameter.kind() == Kind::integer)
        return fmt::format("{} to {}", static_cast<std::int64_t>(parameter.min), static_cast<std::int64_t>(parameter.max));
    return fmt::format("{} to {}{}", number_text(parameter.min), number_text(parameter.max), unit);
}

/// How a value is written.
std::string form_text(const Parameter& parameter) {
    const auto usual = usual_units(parameter.unit);
    const std::string_view example = usual.empty() ? parameter.unit : usual.front();
    const bool plain = parameter.unit == "1";
    const auto number = plain ? "a number" : fmt::format("a number in {} or a text with a unit (\"... {}\")", parameter.unit, example);
    switch (parameter.kind()) {
        case Kind::number: return number;
        case Kind::auto_number: return number + ", or \"auto\"";
        case Kind::integer: return "an integer";
        case Kind::choice: return fmt::format("\"{}\"", fmt::join(parameter.choices, "\" or \""));
        case Kind::boolean: return "true or false";
        case Kind::text: return "a text";
        case Kind::text_list: return "a text, or a list of texts";
        case Kind::number_list: return number + ", or a list of them";
        case Kind::speed_table:
            return fmt::format(
                "{}, a list of at most {} points [speed, value], or {{csv = \"FILE\", time = \"COLUMN\", value = \"COLUMN\"}} "
                "with the speed in column time",
                number, max_speed_points);
        case Kind::time_table:
            return number +
                   ", a list of points [time, value], linear between them, or {csv = \"FILE\", time = \"COLUMN\", value = \"COLUMN\"}";
    }
    return {};
}

}  // namespace

std::string readable_value(const Parameter& parameter, const Scene& scene) {
    const std::string plain = value_text(parameter, scene);
    if (parameter.unit.empty() || parameter.unit == "1" || plain.starts_with('"')) return plain;
    const auto parsed = parse_quantity(plain);
    const auto* number = std::get_if<Quantity>(&parsed);
    return number == nullptr ? fmt::format("{} {}", plain, parameter.unit) : quantity_text(number->value, parameter.unit);
}

std::string explain(std::string_view key) {
    const Parameter* parameter = find_parameter(key);
    if (!parameter) throw SceneError(fmt::format("{}: unknown key{}", key, engine::did_you_mean(nearest_keys(key))));
    std::string text = fmt::format("{}\n  {}\n", parameter->key, parameter->meaning);
    text += fmt::format("  value:    {}\n", form_text(*parameter));
    if (!parameter->unit.empty()) text += fmt::format("  range:    {}\n", range_text(*parameter));
    text += fmt::format("  default:  {}\n", readable_value(*parameter, Scene{}));
    text += fmt::format("  source:   {}\n", parameter->source);
    return text;
}

}  // namespace cvtflow::tasks
