#pragma once
/// Internal to engine/record: opens files for reading, with errors that a user can act on.

#include <string>

#include "engine/record/hdf5_handle.hpp"

namespace cvtflow::engine::hdf5 {

/// Opens a file of the given kind, also if a writer has it open or was killed with it. Nothing of it may have changed on disk.
/// @param format    required value of the attribute `format`, e.g. "cvtflow run"
/// @param version   newest `format_version` that can be read
/// Errors (RecordError): missing, a folder, no HDF5, truncated, damaged, another kind, too new.
[[nodiscard]] Handle open_for_reading(const std::string& path, const std::string& format, std::int64_t version);

}  // namespace cvtflow::engine::hdf5
