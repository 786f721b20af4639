#pragma once
/// TOML as a plain tree with source positions. The one place that knows the TOML library.

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
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
    Position position;  ///< place of the value
};

struct Entry {
    std::string key;
    Position position;  ///< place of the key
    Node node;
};

/// Longest text of a document: four bytes of it may become hundreds in memory [byte].
inline constexpr std::size_t longest_toml = std::size_t{4} << 20U;

/// Most problems that a message lists; those beyond need no hint, which is a search in all names.
inline constexpr std::size_t max_problems = 100;

/// A line per problem, in the order of their positions: "scene.toml:3:1: chain.pns: unknown key"
[[nodiscard]] std::string problems_text(std::vector<Problem> problems, const std::function<std::string(Position)>& place);

/// @return the document's table, or the first violation of the TOML grammar (duplicate keys included) or of what this program takes: texts
/// up to longest_toml, keys of up to 256 characters and 32 parts, values nested up to 32 deep
[[nodiscard]] std::variant<Node, Problem> parse_toml(const std::string& text);

/// TOML literal of a text, with escapes.
[[nodiscard]] std::string toml_text(const std::string& text);

/// The first excess over the limits on size and depth, in one pass. Distinguishes no more of the grammar than texts from the rest.
[[nodiscard]] std::optional<Problem> beyond_limits(const std::string& text);

}  // namespace cvtflow::tasks
