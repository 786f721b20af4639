#pragma once
/// Internal to engine/record: a file inspected by a child process, which may crash of it.
///
/// HDF5 1.10.8 trusts metadata with valid checksums, which a forged file can have: some such files make it crash, or run
/// for ever. What a child has survived, its parent survives, since both see the same bytes; what it was refused, the parent does not try.

#include <functional>

#include "engine/record/hdf5/hdf5_handle.hpp"

namespace cvtflow::engine::hdf5 {

/// Opens everything in a file: objects, attributes, the first and last row of every dataset. Throws Failure for groups that cannot be
/// listed.
void inspect_everything(hid_t file);

/// Such files may be forged, or the machine very slow.
struct OverLimit : Failure {
    using Failure::Failure;
};

/// Runs `inspect` in a child with 1 s of processor time and 1 GiB of memory more than there is; time that it waits for a slow disk or
/// network does not count. Does nothing unless the program has asked for it (try_files_first), and where other threads run, of which one
/// may hold the library's lock. Throws the Failure that `inspect` throws there, Failure("HDF5 crashes on it"), OverLimit("HDF5 needs more
/// than 1 s of processor time for it") or OverLimit("HDF5 needs more than 1 GiB for it").
void inspect_in_child(const std::function<void()>& inspect);

}  // namespace cvtflow::engine::hdf5
