#include "tasks/batch/sweep/sweep_keys.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "engine/base/text.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::tasks {

namespace {

const std::vector<std::string_view> scale_choices{"linear", "log"}, sample_choices{"random", "latin-hypercube"},
    mode_choices{"scene", "settle", "shared"};
const std::vector<SweepKey> sweep_rows{
    {"sweep", "name", SweepForm::text, "the file's name", "Name of the sweep."},
    {"sweep", "description", SweepForm::text, "empty", "Purpose of the sweep, in one or two sentences."},
    {"sweep", "scene", SweepForm::text, "", "Ready scene, or a file relative to the sweep's."},
    {"sweep", "detail", SweepForm::text, "the scene's", "Level of detail (cvtflow list detail)."},
    {"sweep", "only", SweepForm::cases, "all",
     "Cases that run, numbered anew: their numbers, or those at the corners of the axes, at most 8."},
    {"set", "*", SweepForm::scene_keys, "the scene's", "Keys of the scene that apply to all cases, written as in a scene."},
    {"axes", "key", SweepForm::text, "none", "Key of the scene that varies along this axis; every axis multiplies the cases."},
    {"axes", "values", SweepForm::values, "none", "The values of `key`, as a list."},
    {"axes", "from", SweepForm::value, "none", "First value of a range of `key`; requires to and count."},
    {"axes", "to", SweepForm::value, "none", "Last value of a range."},
    {"axes", "count", SweepForm::integer, "none", "Number of values of a range, or of samples; at most a million."},
    {"axes", "scale", SweepForm::choice, "\"linear\"", "How a range is divided.", scale_choices},
    {"axes", "zip", SweepForm::tables, "none", "Keys that vary together: tables with key and values, or key and range."},
    {"axes", "sample", SweepForm::choice, "none", "Samples drawn from the box `keys`; requires count.", sample_choices},
    {"axes", "seed", SweepForm::integer, "0", "Seed of a sample."},
    {"axes", "keys", SweepForm::tables, "none", "The box from which a sample is drawn: tables with key, from and to."},
    {"axes", "csv", SweepForm::text, "none",
     "Rows from a file; its first line names keys, with units in brackets unless cells have units."},
    {"axes", "columns", SweepForm::tables, "all, named by keys",
     "Columns of the file of `csv` that are used, and the keys that they set: tables with column and key. Rows are cases."},
    {"axes.columns", "column", SweepForm::text, "", "Name of a column in the file's first line, without its unit."},
    {"axes.columns", "key", SweepForm::text, "", "Key of the scene."},
    {"axes.zip", "key", SweepForm::text, "", "Key of the scene."},
    {"axes.zip", "values", SweepForm::values, "none", "Its values, as many as for the other keys."},
    {"axes.zip", "from", SweepForm::value, "none", "First value of a range."},
    {"axes.zip", "to", SweepForm::value, "none", "Last value of a range."},
    {"axes.zip", "count", SweepForm::integer, "none", "Number of values of a range."},
    {"axes.zip", "scale", SweepForm::choice, "\"linear\"", "How a range is divided.", scale_choices},
    {"axes.keys", "key", SweepForm::text, "", "Key of the scene."},
    {"axes.keys", "from", SweepForm::value, "", "Lower end of the box."},
    {"axes.keys", "to", SweepForm::value, "", "Upper end of the box."},
    {"axes.keys", "scale", SweepForm::choice, "\"linear\"", "Whether values or their logarithms are distributed uniformly.", scale_choices},
    {"outputs", "scalars", SweepForm::texts, "", "Results of a case: channel, element and reduction, or a quotient of two of them."},
    {"outputs", "from", SweepForm::time, "0", "Outputs before this time are ignored."},
    {"outputs", "records", SweepForm::boolean, "false", "One record per case in the folder records of the results."},
    {"budget", "steps", SweepForm::integer, "run.max_steps of the scene", "Largest number of steps of a case."},
    {"budget", "wall", SweepForm::time, "run.max_wall of the scene", "Longest wall time of a case."},
    {"start", "mode", SweepForm::choice, "\"scene\"",
     "The scene's own start; every case settles; or settled once for all cases of one machine.", mode_choices},
    {"start", "continuation", SweepForm::text, "none",
     "Key of the last axis; along it, and in rows of a csv as long as it rises, a case starts from the end of the case before."},
    {"start", "across", SweepForm::text, "none",
     "Key of the axis before the last, or of the csv, along which lines of a continuation follow each other: their cases start by both."},
    {"start", "check", SweepForm::integer, "1",
     "Number of continued cases that also run from a settled start; the summary reports the difference."},
    {"steady", "confirm", SweepForm::integer, "5",
     "With run.until = \"steady\": number of random cases that run three times as long; the summary reports what that changes."},
    {"steady", "seed", SweepForm::integer, "0", "Seed of that draw."},
    {"accuracy", "target", SweepForm::share, "",
     "Target: largest error of every scalar. Detail, method and step are chosen at the corners of the axes; some cases are verified."},
    {"accuracy", "verify", SweepForm::integer, "10", "Number of random cases that are verified against a reference run."},
    {"accuracy", "seed", SweepForm::integer, "0", "Seed of that draw."},
};

std::string form_of(const SweepKey& row) {
    using enum SweepForm;
    switch (row.form) {
        case text: return "a text";
        case integer: return "an integer";
        case boolean: return "true or false";
        case time: return "a number in s or a text with a unit (\"... ms\")";
        case share: return "a share as a text (\"1 %\") or a number, at most a half";
        case choice: return fmt::format("\"{}\"", fmt::join(row.choices, "\" or \""));
        case value: return "as the scene's key is written";
        case values: return "a list of values as the scene's key is written";
        case texts: return "a list of texts (\"slip mean\", \"tips/axial_force[*] max\", \"ratio at 1 ms\")";
        case tables: return fmt::format("a list of tables (cvtflow explain sweep.{}.{})", row.table, row.name);
        case cases: return "a list of numbers, or \"corners\"";
        case scene_keys: return "as in a scene (cvtflow list keys)";
    }
    return {};
}

std::string explained(const SweepKey& row) {
    return fmt::format("{}\n  {}\n  value:    {}\n  default:  {}\n", row.key(), row.meaning, form_of(row),
                       row.required() ? "none (required)" : row.usual);
}

}  // namespace

std::string SweepKey::key() const { return table == "sweep" ? fmt::format("sweep.{}", name) : fmt::format("sweep.{}.{}", table, name); }

std::span<const SweepKey> sweep_keys() { return sweep_rows; }

std::vector<std::string> sweep_sections() {
    std::vector<std::string> sections;
    for (const SweepKey& row : sweep_rows) {
        const std::string section(row.table.substr(0, row.table.find('.')));
        if (std::find(sections.begin(), sections.end(), section) == sections.end()) sections.push_back(section);
    }
    return sections;
}

std::vector<std::string> sweep_choices(std::string_view table, std::string_view name) {
    for (const SweepKey& row : sweep_rows)
        if (row.table == table && row.name == name) return {row.choices.begin(), row.choices.end()};
    return {};
}

bool names_sweep(std::string_view word) noexcept { return word == "sweep" || word.starts_with("sweep."); }

std::string explain_sweep(std::string_view word) {
    std::string text;
    std::vector<std::string> keys;
    for (const SweepKey& row : sweep_rows) {
        keys.push_back(row.key());
        if (keys.back() == word || keys.back().starts_with(fmt::format("{}.", word))) text += (text.empty() ? "" : "\n") + explained(row);
    }
    if (text.empty())
        throw SceneError(fmt::format("{}: unknown key of a sweep{}", word, engine::did_you_mean(engine::closest(word, keys))));
    return text;
}

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
        case SweepForm::cases: return {{"type", {"array", "string"}}, {"items", {{"type", "integer"}}}};
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
        if (row.required()) schema["required"].push_back(row.name);
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

namespace {

/// Names of the keys of a table.
std::vector<std::string> names_in_sweep(std::string_view table) {
    std::vector<std::string> names;
    for (const SweepKey& row : sweep_rows)
        if (row.table == table) names.emplace_back(row.name);
    return names;
}

/// Words of others for keys of sweeps, and those keys.
constexpr std::pair<std::string_view, std::string_view> synonyms[] = {
    {"step", "count"},    {"steps", "count"},  {"n", "count"},         {"num", "count"},      {"number", "count"}, {"points", "count"},
    {"start", "from"},    {"begin", "from"},   {"min", "from"},        {"end", "to"},         {"stop", "to"},      {"until", "to"},
    {"max", "to"},        {"name", "key"},     {"parameter", "key"},   {"value", "values"},   {"list", "values"},  {"file", "csv"},
    {"spacing", "scale"}, {"error", "target"}, {"columns", "scalars"}, {"results", "scalars"}};

/// The known key that an unknown one probably means; empty if there is none.
std::string likely_key(const std::string& word, const std::vector<std::string>& known) {
    for (const auto& [other, key] : synonyms) {
        if (other == word && std::ranges::find(known, key) != known.end()) return std::string(key);
    }
    return engine::closest(word, known);
}

}  // namespace

TableView::TableView(std::string name, const Node::Table& table, Position position, std::vector<Problem>& problems)
    : name_(std::move(name)), table_(table), position_(position), problems_(problems) {
    const std::vector<std::string> known = names_in_sweep(name_);
    for (const Entry& entry : table) {
        if (std::find(known.begin(), known.end(), entry.key) != known.end()) continue;
        problem(entry.position, fmt::format("{}: unknown key{}", entry.key,
                                            problems_.size() < max_problems ? engine::did_you_mean(likely_key(entry.key, known)) : ""));
    }
}

void TableView::problem(Position position, const std::string& message) const {
    problems_.push_back({position, fmt::format("{}.{}", name_, message)});
}

const Node* TableView::find(std::string_view key) const {
    const auto entry = std::find_if(table_.begin(), table_.end(), [&](const Entry& each) { return each.key == key; });
    return entry == table_.end() ? nullptr : &entry->node;
}

bool TableView::require(std::string_view key) const {
    if (has(key)) return true;
    problem(position_, fmt::format("{}: is missing", key));
    return false;
}

/// The value of a key that is there; nullptr, with a problem, if it has another type.
template <class T>
const T* TableView::typed(std::string_view key, const char* otherwise) const {
    const Node* node = find(key);
    const T* value = node != nullptr ? std::get_if<T>(&node->value) : nullptr;
    if (node != nullptr && value == nullptr) problem(node->position, fmt::format("{}: {}", key, otherwise));
    return value;
}

std::optional<std::string> TableView::text(std::string_view key) const {
    const auto* value = typed<std::string>(key, "not a text");
    return value != nullptr ? std::optional(*value) : std::nullopt;
}

std::optional<std::int64_t> TableView::integer(std::string_view key, std::int64_t min, std::int64_t max) const {
    const auto* value = typed<std::int64_t>(key, "not an integer");
    if (value == nullptr) return {};
    if (*value >= min && *value <= max) return *value;
    problem(find(key)->position, fmt::format("{}: {} is outside [{}, {}]", key, *value, min, max));
    return {};
}

std::optional<bool> TableView::boolean(std::string_view key) const {
    const auto* value = typed<bool>(key, "neither true nor false");
    return value != nullptr ? std::optional(*value) : std::nullopt;
}

const Node::Array* TableView::list(std::string_view key) const {
    const auto* value = typed<Node::Array>(key, "not a list");
    if (value == nullptr || !value->empty()) return value;
    problem(find(key)->position, fmt::format("{}: the list is empty", key));
    return nullptr;
}

void TableView::each_table(std::string_view key, const char* form, const std::function<void(const TableView&)>& read) const {
    const Node::Array* parts = list(key);
    for (const Node& part : parts != nullptr ? *parts : Node::Array{}) {
        const auto* table = std::get_if<Node::Table>(&part.value);
        if (table == nullptr) return problem(part.position, fmt::format("{}: not a table {{{}}}", key, form));
        read(TableView(fmt::format("{}.{}", name_, key), *table, part.position, problems_));
    }
}

std::optional<int> TableView::choice(std::string_view key) const {
    const auto value = text(key);
    if (!value) return {};
    const std::vector<std::string> choices = sweep_choices(name_, key);
    const auto found = std::find(choices.begin(), choices.end(), *value);
    if (found != choices.end()) return static_cast<int>(found - choices.begin());
    problem(find(key)->position, fmt::format("{}: {} is not one of {}{}", key, toml_text(*value), fmt::join(choices, ", "),
                                             engine::did_you_mean(engine::closest(*value, choices))));
    return {};
}

std::optional<double> TableView::time(std::string_view key) const {
    const Node* node = find(key);
    if (node == nullptr) return {};
    if (const auto* text = std::get_if<std::string>(&node->value)) {
        const auto parsed = parse_quantity(*text);
        const auto* quantity = std::get_if<Quantity>(&parsed);
        if (quantity != nullptr && quantity->has_unit && quantity->dimension == dimension_of("s") && quantity->value >= 0.0)
            return quantity->value;
    }
    problem(node->position, fmt::format("{}: not a time such as \"1 ms\"", key));
    return {};
}

std::optional<double> TableView::share(std::string_view key) const {
    const Node* node = find(key);
    if (node == nullptr) return {};
    std::optional<double> share;
    if (const auto* text = std::get_if<std::string>(&node->value)) share = read_accuracy(*text);
    if (const auto* number = std::get_if<double>(&node->value)) share = read_accuracy(fmt::format("{:.17g}", *number));
    if (!share) problem(node->position, fmt::format("{}: not a share above 0 and up to 50 %, such as \"1 %\"", key));
    return share;
}

}  // namespace cvtflow::tasks
