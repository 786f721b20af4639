#pragma once
/// Internal to engine/record: opens files for reading, with errors that a user can act on.

#include <string>

#include "engine/record/hdf5/file_seal.hpp"
#include "engine/record/hdf5/hdf5_handle.hpp"

namespace cvtflow::engine::hdf5 {

/// A kind of file.
struct FileKind {
    const char* format;    ///< required value of the attribute `format`, e.g. "cvtflow run"; nullptr: any
    std::int64_t version;  ///< newest `format_version` that can be read
};

struct OpenFile {
    Handle file;
    bool sealed = false;
};

/// Opens a file of the given kind, also if a writer has it open or was killed with it. Nothing of it may have changed on disk.
/// Errors (RecordError): missing, not a regular file, no HDF5, truncated, damaged, another kind, too new. A file whose seal is broken never
/// reaches HDF5.
/// @throws std::bad_alloc where HDF5, which crashes without memory, would soon be without
[[nodiscard]] OpenFile open_for_reading(const std::string& path, const FileKind& kind);

/// The attribute `format` of any HDF5 file; empty if it has none. Errors as above.
[[nodiscard]] std::string format_of(const std::string& path);

}  // namespace cvtflow::engine::hdf5
