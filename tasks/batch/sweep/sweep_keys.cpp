#include "tasks/batch/sweep/sweep_keys.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/text.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {

namespace {

const std::vector<SweepKey> sweep_rows{
    {"sweep", "name", SweepForm::text, false, {}, "the file's name", "Name of the sweep."},
    {"sweep", "description", SweepForm::text, false, {}, "empty", "Purpose of the sweep, in one or two sentences."},
    {"sweep", "scene", SweepForm::text, true, {}, "", "Ready scene, or a file relative to the sweep's."},
    {"sweep", "detail", SweepForm::text, false, {}, "the scene's", "Level of detail (cvtflow list detail)."},
    {"set", "*", SweepForm::scene_keys, false, {}, "the scene's", "Keys of the scene that apply to all cases, written as in a scene."},
    {"axes", "key", SweepForm::text, false, {}, "none", "Key of the scene that varies along this axis; every axis multiplies the cases."},
    {"axes", "values", SweepForm::values, false, {}, "none", "The values of `key`, as a list."},
    {"axes", "from", SweepForm::value, false, {}, "none", "First value of a range of `key`; requires to and count."},
    {"axes", "to", SweepForm::value, false, {}, "none", "Last value of a range."},
    {"axes", "count", SweepForm::integer, false, {}, "none", "Number of values of a range, or of samples; at most a million."},
    {"axes", "scale", SweepForm::choice, false, {"linear", "log"}, "\"linear\"", "How a range is divided."},
    {"axes", "zip", SweepForm::tables, false, {}, "none", "Keys that vary together: tables with key and values, or key and range."},
    {"axes",
     "sample",
     SweepForm::choice,
     false,
     {"random", "latin-hypercube"},
     "none",
     "Samples drawn from the box `keys`; requires count and seed."},
    {"axes", "seed", SweepForm::integer, false, {}, "none", "Seed of a sample."},
    {"axes", "keys", SweepForm::tables, false, {}, "none", "The box from which a sample is drawn: tables with key, from and to."},
    {"axes",
     "csv",
     SweepForm::text,
     false,
     {},
     "none",
     "Rows from a file; its first line names keys, with units in brackets unless cells have units."},
    {"axes",
     "columns",
     SweepForm::tables,
     false,
     {},
     "all, named by keys",
     "Columns of the file of `csv` that are used, and the keys that they set: tables with column and key. Rows are cases."},
    {"axes.columns", "column", SweepForm::text, true, {}, "", "Name of a column in the file's first line, without its unit."},
    {"axes.columns", "key", SweepForm::text, true, {}, "", "Key of the scene."},
    {"axes.zip", "key", SweepForm::text, true, {}, "", "Key of the scene."},
    {"axes.zip", "values", SweepForm::values, false, {}, "none", "Its values, as many as for the other keys."},
    {"axes.zip", "from", SweepForm::value, false, {}, "none", "First value of a range."},
    {"axes.zip", "to", SweepForm::value, false, {}, "none", "Last value of a range."},
    {"axes.zip", "count", SweepForm::integer, false, {}, "none", "Number of values of a range."},
    {"axes.zip", "scale", SweepForm::choice, false, {"linear", "log"}, "\"linear\"", "How a range is divided."},
    {"axes.keys", "key", SweepForm::text, true, {}, "", "Key of the scene."},
    {"axes.keys", "from", SweepForm::value, true, {}, "", "Lower end of the box."},
    {"axes.keys", "to", SweepForm::value, true, {}, "", "Upper end of the box."},
    {"axes.keys",
     "scale",
     SweepForm::choice,
     false,
     {"linear", "log"},
     "\"linear\"",
     "Whether values or their logarithms are distributed uniformly."},
    {"outputs",
     "scalars",
     SweepForm::texts,
     true,
     {},
     "",
     "Results of a case: channel, element and reduction, or a quotient of two of them."},
    {"outputs", "from", SweepForm::time, false, {}, "0", "Outputs before this time are ignored."},
    {"outputs", "records", SweepForm::boolean, false, {}, "false", "One record per case in the folder records of the results."},
    {"budget", "steps", SweepForm::integer, false, {}, "run.max_steps of the scene", "Largest number of steps of a case."},
    {"budget", "wall", SweepForm::time, false, {}, "run.max_wall of the scene", "Longest wall time of a case."},
    {"start",
     "mode",
     SweepForm::choice,
     false,
     {"scene", "settle", "shared"},
     "\"scene\"",
     "The scene's own start; every case settles; or settled once for all cases of one machine."},
    {"start",
     "continuation",
     SweepForm::text,
     false,
     {},
     "none",
     "Key of the last axis; along it a case starts from the end of the case before."},
    {"start",
     "check",
     SweepForm::integer,
     false,
     {},
     "1",
     "Number of continued cases that also run from a settled start; the summary reports the difference."},
    {"accuracy",
     "target",
     SweepForm::share,
     true,
     {},
     "",
     "Target: largest error of every scalar. Detail, method and step are chosen at the corners of the axes; some cases are verified."},
    {"accuracy", "verify", SweepForm::integer, false, {}, "10", "Number of random cases that are verified against a reference run."},
    {"accuracy", "seed", SweepForm::integer, false, {}, "0", "Seed of that draw."},
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
        case scene_keys: return "as in a scene (cvtflow list keys)";
    }
    return {};
}

std::string explained(const SweepKey& row) {
    return fmt::format("{}\n  {}\n  value:    {}\n  default:  {}\n", row.key(), row.meaning, form_of(row),
                       row.required ? "none (required)" : row.usual);
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

std::vector<std::string> names_in_sweep(std::string_view table) {
    std::vector<std::string> names;
    for (const SweepKey& row : sweep_rows)
        if (row.table == table) names.emplace_back(row.name);
    return names;
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

}  // namespace cvtflow::tasks
