#include <nlohmann/json.hpp>
#include <string>

#include "tasks/batch/sweep/sweep_keys.hpp"
#include "tasks/scene/parameter_table.hpp"

namespace cvtflow::tasks {

namespace {

using Json = nlohmann::ordered_json;

Json table_schema(std::string_view table);

Json form_schema(const SweepKey& row) {
    const Json number_or_text{{"anyOf", {{{"type", "number"}}, {{"type", "string"}}}}};
    switch (row.form) {
        case SweepForm::text: return {{"type", "string"}};
        case SweepForm::integer: return {{"type", "integer"}, {"minimum", 0}};
        case SweepForm::boolean: return {{"type", "boolean"}};
        case SweepForm::time:
        case SweepForm::share:
        case SweepForm::value: return number_or_text;
        case SweepForm::choice: return {{"enum", row.choices}};
        case SweepForm::values: return {{"type", "array"}, {"minItems", 1}};
        case SweepForm::texts: return {{"type", "array"}, {"items", {{"type", "string"}}}, {"minItems", 1}};
        case SweepForm::tables:
            return {{"type", "array"}, {"items", table_schema(std::string(row.table) + "." + std::string(row.name))}, {"minItems", 1}};
        case SweepForm::scene_keys: return {};
    }
    return {};
}

/// An object with the keys of a table and no others.
Json table_schema(std::string_view table) {
    Json schema{{"type", "object"}, {"additionalProperties", false}};
    for (const SweepKey& row : sweep_keys()) {
        if (row.table != table) continue;
        Json& value = schema["properties"][std::string(row.name)];
        value = form_schema(row);
        value["description"] = row.meaning;
        if (row.required) schema["required"].push_back(row.name);
    }
    return schema;
}

/// An axis is of one of four kinds.
Json axes_schema() {
    Json axis = table_schema("axes");
    for (const char* kind : {"key", "zip", "sample", "csv"}) axis["anyOf"].push_back({{"required", {kind}}});
    return {{"type", "array"}, {"items", axis}, {"minItems", 1}};
}

}  // namespace

std::string sweep_schema() {
    Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "cvtflow sweep"}, {"type", "object"}};
    schema["additionalProperties"] = false;
    for (const std::string& section : sweep_sections()) schema["properties"][section] = table_schema(section);
    schema["properties"]["axes"] = axes_schema();
    Json& set = schema["properties"]["set"];
    set = {{"type", "object"}, {"additionalProperties", false}};
    set["properties"] = Json::parse(json_schema())["properties"];
    schema["required"] = {"sweep", "axes", "outputs"};
    return schema.dump(2) + "\n";
}

}  // namespace cvtflow::tasks
