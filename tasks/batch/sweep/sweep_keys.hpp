#pragma once
/// The table of all keys of a sweep file. Reader, explain, JSON schema, documents and tests use it; no other list of them exists. And how
/// a reader sees one of the file's tables.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tasks/scene/toml_tree.hpp"

namespace cvtflow::tasks {

/// Notation of a key's value.
enum class SweepForm { text, integer, boolean, time, share, choice, value, values, texts, tables, cases, scene_keys };

struct SweepKey {
    std::string_view table;  ///< table with its parents in the file: "sweep", "axes", "axes.zip" …
    std::string_view name;   ///< name within its table; "*" in [set]: any key of a scene
    SweepForm form = SweepForm::text;
    std::string_view usual;  ///< default; empty: the key is required in every table of its kind
    std::string_view meaning;
    std::vector<std::string_view> choices{};  ///< values of a choice, in the order of the enumerators

    [[nodiscard]] bool required() const noexcept { return usual.empty(); }
    /// "sweep.scene" of [sweep], "sweep.axes.key" of the other tables.
    [[nodiscard]] std::string key() const;
};

/// All rows; the keys of a table are adjacent.
[[nodiscard]] std::span<const SweepKey> sweep_keys();

/// Top-level tables of a sweep file, in the order of the rows.
[[nodiscard]] std::vector<std::string> sweep_sections();

/// Choices of a key of a table; empty if it is no choice.
[[nodiscard]] std::vector<std::string> sweep_choices(std::string_view table, std::string_view name);

/// Whether a word belongs to sweeps: "sweep", or "sweep." and something.
[[nodiscard]] bool names_sweep(std::string_view word) noexcept;

/// Text of `cvtflow explain` for a key ("sweep.axes.key"), of a table's keys ("sweep.axes") or of all ("sweep").
/// @throws SceneError  unknown key, with the key that was probably meant
[[nodiscard]] std::string explain_sweep(std::string_view word);

/// JSON schema (draft 2020-12) of a sweep file, for editors.
[[nodiscard]] std::string sweep_schema();

/// A TOML table of a sweep for readers: keys checked against sweep_keys(), values by type, problems with positions.
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
    /// Reads the tables of a list, "zip" of "axes" as "axes.zip", up to an element that is not a table. @param form  "key = …, values = …"
    void each_table(std::string_view key, const char* form, const std::function<void(const TableView&)>& read) const;
    /// A time with its unit [s].
    [[nodiscard]] std::optional<double> time(std::string_view key) const;
    /// An accuracy, as read_accuracy() takes it, or a number [1].
    [[nodiscard]] std::optional<double> share(std::string_view key) const;
    /// The key must be there.
    [[nodiscard]] bool require(std::string_view key) const;

private:
    template <class T>
    [[nodiscard]] const T* typed(std::string_view key, const char* otherwise) const;

    std::string name_;
    const Node::Table& table_;
    Position position_;
    std::vector<Problem>& problems_;
};

}  // namespace cvtflow::tasks
