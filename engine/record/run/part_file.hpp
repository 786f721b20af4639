#pragma once
/// A file under construction: `<name>.part` beside its final name, which appears complete or not at all. A lock keeps a second writer out.

#include <cstddef>
#include <string>

#include "engine/base/input_file.hpp"
#include "engine/record/run/output_rule.hpp"

namespace cvtflow::engine {

/// Locks a whole file against other writers (not against readers) until `descriptor` is closed.
/// @param path for messages   @return false if it is locked already, here or in another process
/// @throws RecordError where the system cannot lock: going on would let two runs write into one file
[[nodiscard]] bool lock_file(int descriptor, const std::string& path);

/// Holds `<name>.part` open and locked against other writers (not against readers). Knows nothing of the contents.
/// Errors are RecordError.
class PartFile {
public:
    /// Creates or empties `<path>.part`. Errors: another process writing the same file; not allowed by the system.
    explicit PartFile(const Permit& permit);

    [[nodiscard]] const std::string& path() const noexcept { return part_path_; }
    [[nodiscard]] const std::string& final_path() const noexcept { return final_path_; }

    /// Makes sure that the file can grow to `end` bytes, so that a full disk is noticed before a half-written record exists.
    /// Where the file system cannot reserve, only the process's file size limit is checked. @return 0 or an errno
    [[nodiscard]] int reserve(std::size_t end) noexcept;
    /// Writes all of it at the file's beginning (for contents that were built in memory). @return 0 or an errno
    [[nodiscard]] int write(const void* bytes, std::size_t size) noexcept;
    /// Reads what was written, by whatever descriptor, and puts the seal behind it (file_seal.hpp). @return 0 or an errno
    [[nodiscard]] int seal() noexcept;
    /// Waits until the data are on disk. @return 0 or an errno
    [[nodiscard]] int sync() noexcept;
    /// Gives back what was reserved beyond the end.
    void trim() noexcept;
    /// Syncs, renames to the final name, syncs the folder; not `durable`: renames only. @throws RecordError if another file has the name
    /// since it was permitted; the .part file stays
    void publish(bool durable = true);
    /// Deletes the .part file.
    void discard() noexcept;
    /// Deletes the .part file and throws RecordError("FILE: cannot write: …") for an errno of the functions above.
    void require(int reason);

private:
    Permit permit_;
    std::string final_path_;
    std::string part_path_;
    Descriptor descriptor_;
    std::size_t reserved_ = 0;
};

/// Whether a file is locked by lock_file: in another process, or here. Takes no lock; false for a file that cannot be read.
[[nodiscard]] bool being_written(const std::string& path);

/// Files of a run that is resumed.
struct FormerFiles {
    IsOwn own;             ///< whether a file is the run's; it may throw for one that cannot be read
    IsOwn yields;          ///< whether a finished file of another run is the one that this run was permitted to replace when it began
    bool replace = false;  ///< whether any other file may be replaced
};

/// Takes what a run left under a name out of the way of a new one, to read it: `<path>.before` from now on, or already since an attempt
/// that was killed. Takes the .part file if there is one, else the finished file. No other file is renamed.
/// @return the path to read, empty if there is nothing. Errors (RecordError): a run is still writing it; not allowed; a file of another
/// run, without `replace`.
[[nodiscard]] std::string set_aside(const std::string& path, const FormerFiles& files);

}  // namespace cvtflow::engine
