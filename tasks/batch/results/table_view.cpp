#include "tasks/batch/results/table_view.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/text.hpp"
#include "tasks/batch/sweep/sweep_keys.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::tasks {

namespace {

/// Words of others for keys of sweeps.
struct Synonym {
    std::string_view word, key;
};
constexpr Synonym synonyms[] = {
    {"step", "count"},    {"steps", "count"},  {"n", "count"},         {"num", "count"},      {"number", "count"}, {"points", "count"},
    {"start", "from"},    {"begin", "from"},   {"min", "from"},        {"end", "to"},         {"stop", "to"},      {"until", "to"},
    {"max", "to"},        {"name", "key"},     {"parameter", "key"},   {"value", "values"},   {"list", "values"},  {"file", "csv"},
    {"spacing", "scale"}, {"error", "target"}, {"columns", "scalars"}, {"results", "scalars"}};

/// The known key that an unknown one probably means; empty if there is none.
std::string likely_key(const std::string& word, const std::vector<std::string>& known) {
    for (const Synonym& each : synonyms) {
        if (each.word == word && std::find(known.begin(), known.end(), each.key) != known.end()) return std::string(each.key);
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
