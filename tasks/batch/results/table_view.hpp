#pragma once
/// A TOML table of a sweep for readers: keys checked against sweep_keys(), values by type, problems with positions. Internal to
/// tasks/batch.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tasks/scene/toml_tree.hpp"

namespace cvtflow::tasks {

class TableView {
public:
    /// Keys that the table has not in sweep_keys() are problems.
    /// @param name  of the table there and in messages, e.g. "axes"
    TableView(std::string name, const Node::Table& table, Position position, std::vector<Problem>& problems);

    [[nodiscard]] const Node* find(std::string_view key) const;
    [[nodiscard]] bool has(std::string_view key) const { return find(key) != nullptr; }
    [[nodiscard]] Position position() const noexcept { return position_; }
    void problem(Position position, const std::string& message) const;

    /// The value if the key is there; a value of another type is a problem.
    [[nodiscard]] std::optional<std::string> text(std::string_view key) const;
    [[nodiscard]] std::optional<std::int64_t> integer(std::string_view key, std::int64_t min, std::int64_t max) const;
    [[nodiscard]] std::optional<bool> boolean(std::string_view key) const;
    [[nodiscard]] const Node::Array* list(std::string_view key) const;
    /// One of the key's choices, by number.
    [[nodiscard]] std::optional<int> choice(std::string_view key) const;
    /// Reads the tables of a list, "zip" of "axes" as "axes.zip", up to an element that is none. @param form  "key = …, values = …"
    void each_table(std::string_view key, const char* form, const std::function<void(const TableView&)>& read) const;
    /// A time with its unit [s].
    [[nodiscard]] std::optional<double> time(std::string_view key) const;
    /// An accuracy, as read_accuracy() takes it, or a number [1].
    [[nodiscard]] std::optional<double> share(std::string_view key) const;
    /// The key must be there.
    bool require(std::string_view key) const;

private:
    template <class T>
    [[nodiscard]] const T* typed(std::string_view key, const char* otherwise) const;

    std::string name_;
    const Node::Table& table_;
    Position position_;
    std::vector<Problem>& problems_;
};

}  // namespace cvtflow::tasks
