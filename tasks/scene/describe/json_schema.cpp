#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml/toml_tree.hpp"

namespace cvtflow::tasks {
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
    Json schema = or_list(std::move(number), point_schema(last, parameter.min, parameter.max), most);
    schema["anyOf"].push_back({{"type", "object"},
                               {"properties", {{"csv", text}, {"time", text}, {"value", text}}},
                               {"required", {"csv"}},
                               {"additionalProperties", false}});
    return schema;
}

Json value_schema(const Parameter& parameter) {
    const Json number = number_schema(parameter.min, parameter.max);
    switch (parameter.kind()) {
        case Kind::number: return number;
        case Kind::auto_number: return {{"anyOf", {number, {{"const", "auto"}}}}};
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

}  // namespace cvtflow::tasks
