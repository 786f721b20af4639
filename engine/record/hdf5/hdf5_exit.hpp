#pragma once
/// What HDF5 does when a process ends.

namespace cvtflow::engine {

/// HDF5 is to close nothing at exit: every file is closed where that can be reported, and one that could not be (a full disk) would be
/// tried again there, which ends in a crash after the last message; after a damaged file it may find no end ("HDF5: infinite loop closing
/// library"). To be called before anything else of this folder, by a program, not by a library in a host, which may have files that HDF5 is
/// to close.
void disable_hdf5_atexit() noexcept;

}  // namespace cvtflow::engine
