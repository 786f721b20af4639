#pragma once
/// Points of a time table from a CSV file: `{csv = "file.csv", time = "t", value = "torque"}`. The first line of the file has the names of
/// its columns, with a unit in brackets if the cells have none (`t [ms]`); without time and value, the first two columns are taken.

#include <filesystem>
#include <vector>

#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml/toml_tree.hpp"

namespace cvtflow::tasks {

/// Sets a time table of the scene to the points of the file. What is wrong is appended to `problems` with the position of `node` and the
/// place in the file, and leaves the table as it was.
/// @param node   a table
/// @param folder that a relative path counts from
void read_csv_points(const Parameter& parameter, const Node& node, const std::filesystem::path& folder, Scene& scene,
                     std::vector<Problem>& problems);

}  // namespace cvtflow::tasks
