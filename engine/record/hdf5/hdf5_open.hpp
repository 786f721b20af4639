#pragma once
/// Internal to engine/record: opens files for reading, with errors that a user can act on, after a child process has inspected them.
///
/// HDF5 1.10.8 trusts metadata with valid checksums, which a forged file can have: some such files make it crash, or run for ever. The
/// parent opens a file only if a child could: both see the same bytes.

#include <functional>
#include <string>

#include "engine/record/hdf5/file_seal.hpp"
#include "engine/record/hdf5/hdf5_handle.hpp"

namespace cvtflow::engine::hdf5 {

/// A kind of file.
struct FileKind {
    const char* format;    ///< required value of the attribute `format`, e.g. "cvtflow run"; nullptr: any
    std::int64_t version;  ///< newest `format_version` that can be read
    bool always_sealed;    ///< written at once: without a seal it is damaged
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

/// Opens everything in a file: objects, attributes, the first and last row of every dataset. Throws Failure for groups that cannot be
/// listed.
void inspect_everything(hid_t file);

/// Thrown where the file may be forged, or the machine is very slow.
struct OverLimit : Failure {
    using Failure::Failure;
};

/// Runs `inspect` in a child with 1 s of processor time and 1 GiB of memory more than there is; time that it waits for a slow disk or
/// network does not count. Does nothing unless the program has asked for it (try_files_first), and where other threads run, of which one
/// may hold the library's lock. Throws the Failure that `inspect` throws there, Failure("HDF5 crashes on it"), OverLimit("HDF5 needs more
/// than 1 s of processor time for it") or OverLimit("HDF5 needs more than 1 GiB for it").
void inspect_in_child(const std::function<void()>& inspect);

}  // namespace cvtflow::engine::hdf5
