#pragma once
/// Remains of the files that a program has written, after a power cut (tests/faults/power.c records the writes).

#include <cstdint>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

namespace cvtflow::tools {

/// One change to a file or a name, as in the log.
struct Change {
    std::string what;         ///< create, mkdir, remove, rename, write, size, sync
    std::uint64_t inode = 0;  ///< of file or folder; 0 where only names change
    std::size_t at = 0;       ///< of a write; the length that size sets
    std::string bytes;
    std::string path, to;  ///< of names
};

/// Does a write or a new length to the bytes of a file.
void carry_out(const Change& change, std::string& bytes);

/// @param folder  changes outside of it are left out
[[nodiscard]] std::vector<Change> read_power_log(const std::filesystem::path& log, const std::filesystem::path& folder);

/// Guarantee of a system: dropped keeps nothing that was not synced, names only with their folder. journalled is the behaviour of file
/// systems: a sync brings all names before it to disk as well, later ones follow in their order, and of unsynced bytes some pages.
enum class Disk { dropped, journalled };

/// Puts into `folder` what the first `count` changes leave on disk.
/// @param folder  as in the log; empty, but for what was there before   @param chance  for Disk::journalled
void cut_power(const std::vector<Change>& changes, std::size_t count, Disk disk, const std::filesystem::path& folder, std::mt19937& chance);

}  // namespace cvtflow::tools
