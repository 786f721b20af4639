#pragma once
/// Intact rows of a table of cases that HDF5 cannot read any more, for example after a power cut that lost some of its pages.
/// Each row was written with a check (RowLayout::seal), and lies in the file as it lies in memory, so whole rows are found without HDF5.

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/record/table/case_table.hpp"

namespace cvtflow::engine {

/// Whether a file was given up while it grew, and contains a text that identifies it. Also false for files that cannot be read,
/// and for finished ones (they end with a seal), which nothing but a fault of the disk can have changed.
[[nodiscard]] bool torn_while_growing(const std::string& path, std::string_view text);

/// The rows of a file that have the check that they were written with, wherever they lie, in the order of their places.
/// @param layout     of the rows
/// @param plausible  is asked before a check is computed, for every place of the file; should be quick, and refuse most
/// @throws RecordError  the file cannot be read
[[nodiscard]] std::vector<std::byte> whole_rows(const std::string& path, const RowLayout& layout,
                                                const std::function<bool(std::span<const std::byte> row)>& plausible);

}  // namespace cvtflow::engine
