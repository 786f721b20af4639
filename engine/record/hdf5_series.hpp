#pragma once
/// Internal to engine/record: datasets whose first dimension is time or number.

#include <cstddef>
#include <string>
#include <vector>

#include "engine/record/hdf5_handle.hpp"

namespace cvtflow::engine::hdf5 {

/// What one extendible dataset is made of.
struct SeriesShape {
    std::string path;        ///< "/channels/links/tension"
    hid_t type = -1;         ///< of one element, in memory and in the file
    std::size_t width = 1;   ///< elements per row
    bool flat = true;        ///< [rows]; otherwise [rows, width]
    int deflate = 0;         ///< 0…9
    std::size_t chunk = 1;   ///< rows per chunk
};

/// Creates an empty dataset [0…unlimited(, width)] and the groups it is in. Reals that were never written read as NaN. Throws Failure.
[[nodiscard]] Handle create_series(hid_t file, const SeriesShape& shape);

/// Throws Failure("cannot open '<path>': reason").
[[nodiscard]] Handle open_series(hid_t file, const std::string& path);
/// Whether there is a dataset of that path. False also if a group on the way is missing.
[[nodiscard]] bool has_series(hid_t file, const std::string& path);
/// Extent of every dimension, [rows] or [rows, width].
[[nodiscard]] std::vector<std::size_t> extent(hid_t dataset);
/// Copies `count` rows from `first` on, converted to `type`, to memory large enough. Throws Failure, e.g. for damaged data.
void read_rows(hid_t dataset, hid_t type, std::size_t first, std::size_t count, void* memory);

}  // namespace cvtflow::engine::hdf5
