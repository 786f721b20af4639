/// Descriptions of scenes that follow from the table of parameters: of a key for people, JSON schema, TOML of a whole scene.

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/base/text.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml_tree.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::tasks {

namespace {

std::string range_text(const Parameter& parameter) {
    const std::string unit = parameter.unit == "1" ? "" : fmt::format(" {}", parameter.unit);
    if (parameter.kind() == Kind::integer)
        return fmt::format("{} to {}", static_cast<std::int64_t>(parameter.min), static_cast<std::int64_t>(parameter.max));
    return fmt::format("{} to {}{}", number_text(parameter.min), number_text(parameter.max), unit);
}

/// Notation of a value.
std::string form_text(const Parameter& parameter) {
    const auto usual = usual_units(parameter.unit);
    const std::string_view example = usual.empty() ? parameter.unit : usual.front();
    const bool plain = parameter.unit == "1";
    const auto number = plain ? "a number" : fmt::format("a number in {} or a text with a unit (\"... {}\")", parameter.unit, example);
    switch (parameter.kind()) {
        case Kind::number: return number;
        case Kind::auto_number: return fmt::format("{}, or \"{}\"", number, parameter.choices.front());
        case Kind::integer: return "an integer";
        case Kind::choice: return fmt::format("\"{}\"", fmt::join(parameter.choices, "\" or \""));
        case Kind::boolean: return "true or false";
        case Kind::text: return "a text";
        case Kind::text_list: return "a text, or a list of texts";
        case Kind::number_list: return number + ", or a list of them";
        case Kind::speed_table:
            return fmt::format(
                "{}, a list of at most {} points [speed, value], \"FILE.csv\" with these two columns, or {{csv = \"FILE\", speed = "
                "\"COLUMN\", value = \"COLUMN\"}}",
                number, max_speed_points);
        case Kind::time_table:
            return number +
                   ", a list of points [time, value], linear between them, \"FILE.csv\" with these two columns, or {csv = \"FILE\", time = "
                   "\"COLUMN\", value = \"COLUMN\"}";
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
    if (!parameter) throw SceneError(fmt::format("{}: unknown key{}", key, key_hint(key)));
    std::string text = fmt::format("{}\n  {}\n", parameter->key, parameter->meaning);
    text += fmt::format("  value:    {}\n", form_text(*parameter));
    if (!parameter->unit.empty()) text += fmt::format("  range:    {}\n", range_text(*parameter));
    text += fmt::format("  default:  {}\n", readable_value(*parameter, Scene{}));
    text += fmt::format("  source:   {}\n", parameter->source);
    return text;
}

namespace {

using Json = nlohmann::ordered_json;

/// A number in SI, or a text with a unit (whose dimension the parser checks).
Json number_schema(double min, double max) {
    const Json plain{{"type", "number"}, {"minimum", min}, {"maximum", max}};
    const Json with_unit{{"type", "string"}, {"pattern", "^\\s*[-+]?\\.?[0-9]"}};
    return {{"anyOf", {plain, with_unit}}};
}

Json list_schema(Json item, std::size_t most) {
    return {{"type", "array"}, {"items", std::move(item)}, {"minItems", 1}, {"maxItems", most}};
}

Json point_schema(double last, double min, double max) {
    return {{"type", "array"}, {"prefixItems", {number_schema(0.0, last), number_schema(min, max)}}, {"minItems", 2}, {"maxItems", 2}};
}

/// `number` or a list of `item`.
Json or_list(Json number, Json item, std::size_t most = max_points) {
    number["anyOf"].push_back(list_schema(std::move(item), most));
    return number;
}

/// A number, points, or columns of a CSV file.
Json table_schema(Json number, const Parameter& parameter, double last, std::size_t most) {
    const Json text{{"type", "string"}};
    const char* first = parameter.kind() == Kind::speed_table ? "speed" : "time";
    Json schema = or_list(std::move(number), point_schema(last, parameter.min, parameter.max), most);
    schema["anyOf"].push_back({{"type", "object"},
                               {"properties", {{"csv", text}, {first, text}, {"value", text}}},
                               {"required", {"csv"}},
                               {"additionalProperties", false}});
    return schema;
}

Json value_schema(const Parameter& parameter) {
    const Json number = number_schema(parameter.min, parameter.max);
    switch (parameter.kind()) {
        case Kind::number: return number;
        case Kind::auto_number: return {{"anyOf", {number, {{"const", parameter.choices.front()}}}}};
        case Kind::integer:
            return {{"type", "integer"},
                    {"minimum", static_cast<std::int64_t>(parameter.min)},
                    {"maximum", static_cast<std::int64_t>(parameter.max)}};
        case Kind::choice: return {{"enum", parameter.choices}};
        case Kind::boolean: return {{"type", "boolean"}};
        case Kind::text: return {{"type", "string"}};
        case Kind::text_list: {
            const Json text{{"type", "string"}};
            return {{"anyOf", {text, {{"type", "array"}, {"items", text}, {"maxItems", max_points}}}}};
        }
        case Kind::number_list: return or_list(number, number);
        case Kind::time_table: return table_schema(number, parameter, latest_time, max_points);
        case Kind::speed_table: return table_schema(number, parameter, highest_speed, max_speed_points);
    }
    return {};
}

/// The default as JSON: its TOML text is JSON as well, for every kind of value.
Json default_value(const Parameter& parameter) { return Json::parse(value_text(parameter, Scene{})); }

}  // namespace

std::string json_schema() {
    Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "cvtflow scene"}, {"type", "object"}};
    schema["additionalProperties"] = false;
    Json& sections = schema["properties"];
    for (const Parameter& parameter : parameter_table()) {
        Json& section = sections[std::string(parameter.section())];
        section["type"] = "object";
        section["additionalProperties"] = false;
        Json& value = section["properties"][std::string(parameter.name())];
        value = value_schema(parameter);
        const bool plain = parameter.unit.empty() || parameter.unit == "1";
        value["description"] = std::string(parameter.meaning) + (plain ? "" : " [" + std::string(parameter.unit) + "]");
        value["default"] = default_value(parameter);
    }
    return schema.dump(2) + "\n";
}

namespace {

/// A list of the texts of values.
template <class Value, class Text>
std::string list_text(const std::vector<Value>& values, const Text& text) {
    std::vector<std::string> texts;
    for (const Value& value : values) texts.push_back(text(value));
    return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::string table_text(const std::vector<double>& place, const std::vector<double>& value) {
    if (place == std::vector{0.0}) return number_text(value.front());
    std::vector<std::string> points;
    for (std::size_t i = 0; i < place.size(); ++i) points.push_back(list_text(std::vector{place[i], value[i]}, number_text));
    return fmt::format("[{}]", fmt::join(points, ", "));
}

/// Values of members as TOML.
struct MemberText {
    const Parameter& parameter;

    std::string operator()(const double* number) const { return number_text(*number); }
    std::string operator()(const bool* flag) const { return *flag ? "true" : "false"; }
    std::string operator()(const std::string* text) const { return toml_text(*text); }
    std::string operator()(const std::vector<std::string>* texts) const { return list_text(*texts, toml_text); }
    std::string operator()(const model::TimeTable* table) const { return table_text(table->time, table->value); }
    std::string operator()(const model::SpeedTable* table) const { return table_text(table->speed, table->value); }
    std::string operator()(const std::vector<double>* numbers) const {
        return numbers->size() == 1 ? number_text(numbers->front()) : list_text(*numbers, number_text);
    }
    std::string operator()(const AutoNumber* number) const {
        return number->automatic() ? toml_text(std::string(parameter.choices.front())) : number_text(*number);
    }
    template <class T>
    std::string operator()(const T* member) const {
        if constexpr (std::is_enum_v<T>)
            return toml_text(std::string(parameter.choices[static_cast<std::size_t>(*member)]));
        else
            return std::to_string(*member);
    }
};

}  // namespace

std::string value_text(const Parameter& parameter, const Scene& scene) {
    if (parameter.key == level_key) return fmt::format("\"{}\"", level_of(scene).empty() ? "given" : level_of(scene));
    Scene copy = scene;
    return std::visit(MemberText{parameter}, parameter.member(copy));
}

std::string write_scene(const Scene& scene) {
    std::string text;
    std::string_view section;
    for (const Parameter& parameter : parameter_table()) {
        if (parameter.section() != section) text += fmt::format("{}[{}]\n", section.empty() ? "" : "\n", parameter.section());
        section = parameter.section();
        const bool has_unit = !parameter.unit.empty() && parameter.unit != "1";
        const std::string value = value_text(parameter, scene);
        const auto unit = has_unit && !value.starts_with('"') ? fmt::format("  # {}", parameter.unit) : "";
        const bool follows = lacks_floor(scene, parameter.key) &&  // not given: reading the text gives it again
                             value == (is_derived(scene, parameter.key) ? number_text(0.0) : value_text(parameter, Scene{}));
        text += fmt::format("{}{} = {}{}\n", follows ? "# " : "", parameter.name(), value, unit);
    }
    return text;
}

}  // namespace cvtflow::tasks
