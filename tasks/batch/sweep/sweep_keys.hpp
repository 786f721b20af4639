#pragma once
/// The table of all keys of a sweep file. Reader, explain, JSON schema, documents and tests use it; no other list of them exists.

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cvtflow::tasks {

/// How the value of a key is written.
enum class SweepForm { text, integer, boolean, time, share, choice, value, values, texts, tables, scene_keys };

struct SweepKey {
    std::string_view table;  ///< "sweep", "axes", "axes.zip" … as nested in the file
    std::string_view name;   ///< within its table; "*" in [set]: any key of a scene
    SweepForm form = SweepForm::text;
    std::string_view usual;  ///< what holds where it is absent; empty: it is required in every table of its kind
    std::string_view meaning;
    std::vector<std::string_view> choices{};  ///< of a choice, in the order of the enumerators

    [[nodiscard]] bool required() const noexcept { return usual.empty(); }
    /// "sweep.scene" of [sweep], "sweep.axes.key" of the other tables.
    [[nodiscard]] std::string key() const;
};

/// All rows; the keys of a table are adjacent.
[[nodiscard]] std::span<const SweepKey> sweep_keys();

/// Top-level tables of a sweep file, in the order of the rows.
[[nodiscard]] std::vector<std::string> sweep_sections();

/// Names of the keys of a table.
[[nodiscard]] std::vector<std::string> names_in_sweep(std::string_view table);

/// Choices of a key of a table; empty if it is no choice.
[[nodiscard]] std::vector<std::string> sweep_choices(std::string_view table, std::string_view name);

/// Whether a word belongs to sweeps: "sweep", or "sweep." and something.
[[nodiscard]] bool names_sweep(std::string_view word) noexcept;

/// Text of `cvtflow explain` for a key ("sweep.axes.key"), of a table's keys ("sweep.axes") or of all ("sweep").
/// @throws SceneError  unknown key, with the key that was probably meant
[[nodiscard]] std::string explain_sweep(std::string_view word);

/// JSON schema (draft 2020-12) of a sweep file, for editors.
[[nodiscard]] std::string sweep_schema();

}  // namespace cvtflow::tasks
