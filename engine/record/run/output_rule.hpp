#pragma once
/// The one rule for files that are written. docs/records.md promises it to users:
///
///     A command replaces a file only if that file is of the kind that the command writes and of the same scene, run or sweep, or --force
///     is given; FILE.part and every side file counts as FILE. An input is never replaced, not even with --force. A command removes nothing
///     by folder, only files that it wrote, by name.
///
/// Every file is written through a PartFile, and every PartFile asks for a Permit, which only this rule gives. tests/architecture shows
/// that no source opens a file for writing otherwise.

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace cvtflow::engine {

/// Whether an existing file is of the kind that is written, and of the same scene, run or sweep.
using IsOwn = std::function<bool(const std::string& file)>;

/// A writer's rule for the file that it is about to write. By default: a new file; nothing may exist under its name.
struct OutputRule {
    std::string what = "file that may be replaced";  ///< noun in messages: "FILE: already exists and is not a WHAT"
    IsOwn own = nullptr;                             ///< files that may be replaced; nullptr: none
    std::vector<std::filesystem::path> inputs = {};  ///< never replaced, under whatever name; empty paths count as none
    bool force = false;                              ///< any file may be replaced (--force)
    bool former = false;                             ///< an existing file is permitted; set_aside() checks it
    bool named = false;                              ///< the user chose the name: `own` does not count without `force`
    bool repeats = false;  ///< every writer makes it bit for bit: rows in FILE.part, or a file of `own` since, need no `force`
    bool devices = false;  ///< devices and pipes are written as by a shell's `>`
    std::string advice = "--force replaces it";
};

/// The permission to write a file under a name, and which file had that name. It stays valid as long as it exists: a file that was
/// permitted once may be written again, but no file is replaced that another program has put there since.
class Permit {
public:
    /// Permits no file.
    Permit() = default;
    /// Asked before the work whose result goes there. By default: for a new file.
    /// @throws RecordError: an input; another file without `force`; a folder, a symbolic link, a device, pipe or socket; a missing folder;
    /// no permission
    Permit(const std::string& path, const OutputRule& rule = {});

    [[nodiscard]] const std::string& path() const noexcept { return path_; }
    [[nodiscard]] bool empty() const noexcept { return path_.empty(); }
    /// Whether the name is that of a device or pipe (`devices`).
    [[nodiscard]] bool device() const noexcept { return device_; }
    /// "FILE: the existing file is replaced"; empty: nothing was there.
    [[nodiscard]] std::string notice() const;
    /// Asked when the writing begins. @throws RecordError if another file has the name since, or a killed writer's rows are in its .part
    void require_still() const;
    /// Renames a complete file, which has the mode of the one that it replaces. @throws RecordError if another file has the name since
    void give_name(const std::string& complete) const;

private:
    struct Seen;
    [[nodiscard]] bool may_take_name() const;

    std::string path_;
    bool device_ = false, replaces_ = false;
    std::shared_ptr<Seen> seen_;  ///< state that all copies share
};

/// An object under a name that can never be replaced: "a symbolic link; name its target" …; empty: nothing, or a plain file.
[[nodiscard]] std::string other_than_file(const std::string& path);

/// Folder in which a file or folder lies: "." for a plain name.
[[nodiscard]] std::string folder_of(const std::string& path);
/// "the folder 'results' does not exist", for a file or folder that is to be created in it; empty: it exists.
[[nodiscard]] std::string missing_folder(const std::string& path);

/// Whether a file is a record of which the attribute of that name is this text.
[[nodiscard]] IsOwn record_with(std::string attribute, std::string text);
/// Whether a file is what a killed writer left of a record, so that HDF5 cannot read it.
[[nodiscard]] bool is_torn_record(const std::string& file);
/// Whether a file is a state (checkpoints are), or one that was left half written.
[[nodiscard]] bool is_state_file(const std::string& file);
/// Whether a text, picture or archive has all of these marks in its first 4 KiB.
[[nodiscard]] IsOwn text_with(std::vector<std::string> marks);

/// Writes a file as a whole: it takes its name when it is complete, an existing file remains until then. @param durable whether its bytes
/// are on disk before it has its name; else the caller brings them there, sync_files_in(). @throws RecordError "FILE: cannot write: reason"
void write_whole(const Permit& permit, std::string_view bytes, bool durable = true);
/// Brings the files of a folder and their names to disk, by one sync of its file system. @throws RecordError
void sync_files_in(const std::string& folder);

/// Removes plain files of a folder for which own() is true, then the folder if it is empty. No link is followed, no folder entered.
void remove_own_files(const std::filesystem::path& folder, const std::function<bool(const std::filesystem::path& file)>& own);

/// @throws RecordError if the file, or its .part, is one of the inputs, under whatever name
void require_no_input(const std::string& path, const std::vector<std::filesystem::path>& inputs);

}  // namespace cvtflow::engine
