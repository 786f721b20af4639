#pragma once
/// Variations of a sweep: keys of the scene and the values that they take together, row by row; read from a table of [[axes]].

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml_tree.hpp"

namespace cvtflow::tasks {

/// A value of a key: a number (also the position of a choice, 0 or 1 for a boolean), or TOML text (texts, lists and tables of several
/// points).
using AxisValue = std::variant<double, std::string>;

/// One factor of the product that a sweep is.
struct Axis {
    std::string kind;                    ///< "list", "range", "zip", "random", "latin-hypercube" or "csv", for people
    std::vector<const Parameter*> keys;  ///< keys that vary together
    std::vector<AxisValue> values;       ///< [rows * keys], row by row

    [[nodiscard]] std::size_t rows() const noexcept { return keys.empty() ? 0 : values.size() / keys.size(); }
    [[nodiscard]] const AxisValue& at(std::size_t row, std::size_t key) const noexcept { return values[row * keys.size() + key]; }
};

/// Gives a key of the scene a value of an axis. Allocates nothing for numbers, once the scene has held such a value.
void apply(const Parameter& parameter, const AxisValue& value, Scene& scene);

/// TOML text of a value: 150, "elastic", [1, 2].
[[nodiscard]] std::string axis_text(const Parameter& parameter, const AxisValue& value);

/// Whether a key has numbers in between, for ranges and samples.
[[nodiscard]] bool continuous(const Parameter& parameter);

/// `count` numbers from `from` to `to`, both included; evenly spaced, or evenly in their logarithms. Integers are rounded by apply(). from
/// [unit of the key], to [the same]
[[nodiscard]] std::vector<double> spaced(double from, double to, std::size_t count, bool logarithmic);

/// Coordinates in [0, 1) of `count` samples of `dimensions` numbers, row by row; equal on every machine.
[[nodiscard]] std::vector<double> random_samples(std::size_t count, std::size_t dimensions, std::uint64_t seed);
/// Samples as above, with each of the `count` equal intervals of every dimension hit exactly once.
[[nodiscard]] std::vector<double> latin_hypercube(std::size_t count, std::size_t dimensions, std::uint64_t seed);

/// @param folder base of a relative csv path
/// @return an axis without keys if anything is wrong
[[nodiscard]] Axis read_axis(const Entry& entry, const Node& node, const std::filesystem::path& folder, std::vector<Problem>& problems);

/// A column of a CSV file that is taken, and the key that it gives values to.
struct CsvColumn {
    const Parameter* key = nullptr;
    std::string name;
};

/// Rows of a CSV file as an axis: first line names (`load.torque` or `load.torque [N*m]`), then values as in a scene; texts need no quotes.
/// Problems are at `position` and name line and column of the CSV.
/// @param columns to take; none: all of them, named by keys
[[nodiscard]] Axis read_csv_axis(const std::filesystem::path& file, const std::vector<CsvColumn>& columns, Position position,
                                 std::vector<Problem>& problems);

}  // namespace cvtflow::tasks
