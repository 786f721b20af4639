#pragma once
/// TOML as a plain tree with source positions. The one place that knows the TOML library.

#include <compare>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace cvtflow::tasks {

/// Line and column of a source, counted from 1.
struct Position {
    int line = 1;
    int column = 1;
    auto operator<=>(const Position&) const = default;
};

/// One thing that is wrong, and where.
struct Problem {
    Position position;
    std::string message;
};

/// A date or time of day; no key of a scene takes one.
struct Date {};

struct Entry;

struct Node {
    using Array = std::vector<Node>;
    using Table = std::vector<Entry>;
    std::variant<Date, bool, std::int64_t, double, std::string, Array, Table> value;
    Position position;   ///< of the value
};

struct Entry {
    std::string key;
    Position position;   ///< of the key
    Node node;
};

/// @return the document's table, or the first violation of the TOML grammar (duplicate keys included)
[[nodiscard]] std::variant<Node, Problem> parse_toml(const std::string& text);

/// `"text"` with TOML's escapes.
[[nodiscard]] std::string toml_text(const std::string& text);

}  // namespace cvtflow::tasks
