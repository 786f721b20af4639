#include "tasks/scene/toml_tree.hpp"

#include <utility>

#include <fmt/format.h>
#define TOML_EXCEPTIONS 0
#define TOML_ENABLE_FORMATTERS 0
#include <toml++/toml.h>

namespace cvtflow::tasks {
namespace {

Position position_of(const toml::source_region& region) {
    return {static_cast<int>(region.begin.line), static_cast<int>(region.begin.column)};
}

Node converted(const toml::node& source);

Node::Table converted(const toml::table& source) {
    Node::Table table;
    for (const auto& [key, value] : source) table.push_back({std::string(key.str()), position_of(key.source()), converted(value)});
    return table;
}

Node converted(const toml::node& source) {
    Node node;
    node.position = position_of(source.source());
    if (const auto* flag = source.as_boolean()) node.value = flag->get();
    if (const auto* integer = source.as_integer()) node.value = integer->get();
    if (const auto* number = source.as_floating_point()) node.value = number->get();
    if (const auto* text = source.as_string()) node.value = text->get();
    if (const auto* table = source.as_table()) node.value = converted(*table);
    if (const auto* array = source.as_array()) {
        Node::Array elements;
        for (const auto& element : *array) elements.push_back(converted(element));
        node.value = std::move(elements);
    }
    return node;
}

}  // namespace

std::variant<Node, Problem> parse_toml(const std::string& text) {
    const toml::parse_result result = toml::parse(text);
    if (!result) return Problem{position_of(result.error().source()), fmt::format("not valid TOML: {}", result.error().description())};
    return converted(static_cast<const toml::node&>(result.table()));
}

std::string toml_text(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            result += '\\';
            result += c;
        } else if (code < 0x20 || code == 0x7f) {
            result += fmt::format("\\u{:04X}", code);
        } else {
            result += c;
        }
    }
    return result + '"';
}

}  // namespace cvtflow::tasks
