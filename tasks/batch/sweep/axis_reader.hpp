#pragma once
/// Reads one table of [[axes]]. Internal to tasks/batch.

#include <filesystem>
#include <vector>

#include "tasks/batch/sweep/axis.hpp"

namespace cvtflow::tasks {

/// @param folder that a relative csv counts from
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
