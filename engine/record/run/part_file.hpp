#pragma once
/// The one rule for files that are written, which docs/records.md promises to users:
///
///     A command writes FILE.part, syncs it and renames it to FILE. A file that exists is refused without --force, but for default names in
///     results/; with it the old file is gone only when the new one is complete. Nothing else is removed, and an input is never replaced.
///
/// Every file is written through a PartFile.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/input_file.hpp"

namespace cvtflow::engine {

/// Whether an existing plain file may be replaced: FILE, or FILE.part without a writer. It may throw RecordError for "no".
using MayReplace = std::function<bool(const std::string& there)>;

/// A file that is about to be written. A name alone is that of a new file.
struct OutputFile {
    OutputFile(std::string name = {}, MayReplace existing = nullptr, const char* advised = "--force replaces it")
        : path(std::move(name)), may_replace(std::move(existing)), advice(advised) {}

    std::string path;  ///< empty: none
    MayReplace may_replace;
    const char* advice;  ///< what a user can do about a file that is not replaced

    [[nodiscard]] bool empty() const noexcept { return path.empty(); }
    [[nodiscard]] bool replaces(const std::string& there) const;
};

/// Any file (--force), or none.
[[nodiscard]] MayReplace any_file(bool force = true);

/// Checks a place before the work whose result goes there. @throws RecordError: an input, whatever may be replaced; another file that may
/// not be replaced; a folder, symbolic link, device, pipe or socket; a missing folder; no permission; another process that writes it
void require_place(const OutputFile& file, const std::vector<std::filesystem::path>& inputs = {});
/// @throws RecordError if the file, or its .part, is one of the inputs, under whatever name
void require_no_input(const std::string& path, const std::vector<std::filesystem::path>& inputs);
/// Renames a complete file to its name, with the mode of the one that it replaces. @throws RecordError if a file has the name that may not
/// be replaced, also one that appeared since it was checked
void give_name(const std::string& complete, const OutputFile& file);
/// Writes a file as a whole. @throws RecordError "FILE: cannot write: reason"
void write_whole(const OutputFile& file, std::string_view bytes);

/// An object under a name that can never be replaced: "a symbolic link; name its target" …; empty: nothing, or a plain file.
[[nodiscard]] std::string other_than_file(const std::string& path);
/// "the folder 'results' does not exist", for a file or folder that is to be created in it; empty: it exists.
[[nodiscard]] std::string missing_folder(const std::string& path);
/// The first 4 KiB of a file; empty if it cannot be read.
[[nodiscard]] std::string head_of(const std::string& path);

/// Locks a whole file against other writers (not against readers) until `descriptor` is closed.
/// @param path for messages   @return false if it is locked already, here or in another process
/// @throws RecordError where the system cannot lock: going on would let two runs write into one file
[[nodiscard]] bool lock_file(int descriptor, const std::string& path);
/// Whether a file is locked by lock_file: in another process, or here. Takes no lock; false for a file that cannot be read.
[[nodiscard]] bool being_written(const std::string& path);
/// "process 4711", which has a file open; "another process" where the system does not show which.
[[nodiscard]] std::string writer_of(const std::string& path);

/// Holds FILE.part open and locked against other writers (not against readers). Knows nothing of the contents. Errors are RecordError.
class PartFile {
public:
    /// Creates or empties FILE.part. Errors: those of require_place().
    /// @param continues the place was checked: FILE.part is of the same run and remains until take_place(), before which FILE.part.part is
    /// written
    explicit PartFile(const OutputFile& file, bool continues = false);

    [[nodiscard]] const std::string& path() const noexcept { return part_path_; }
    [[nodiscard]] const std::string& final_path() const noexcept { return file_.path; }

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
    /// Renames FILE.part.part to FILE.part, all of whose rows it has, on disk.
    void take_place();
    /// Syncs, renames to the final name, syncs the folder; not `durable`: renames only. @throws RecordError as give_name(); FILE.part stays
    void publish(bool durable = true);
    /// Deletes the .part file.
    void discard() noexcept;
    /// Deletes the .part file and throws RecordError("FILE: cannot write: …") for an errno of the functions above.
    void require(int reason);

private:
    OutputFile file_;
    std::string part_path_;
    Descriptor descriptor_;
    std::size_t reserved_ = 0;
};

}  // namespace cvtflow::engine
