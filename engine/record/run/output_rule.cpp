#include "engine/record/run/output_rule.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <optional>
#include <utility>

#include "engine/base/input_file.hpp"
#include "engine/record/hdf5/hdf5_open.hpp"
#include "engine/record/run/part_file.hpp"
#include "engine/record/run/run_reader.hpp"
#include "engine/record/run/schema.hpp"

namespace cvtflow::engine {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_creation(const std::string& path, const std::string& why) { throw RecordError(path + ": cannot create: " + why); }

constexpr std::size_t head_bytes = 4096, superblock_bytes = 48;  ///< sizes in version 3

/// The first 4 KiB of a file; empty if it cannot be read.
std::string head_of(const std::string& path) {
    std::string head(head_bytes, '\0');
    try {
        head.resize(InputFile(path).read(0, reinterpret_cast<std::byte*>(head.data()), head.size()));
        return head;
    } catch (const InputError&) {
        return {};
    }
}

/// Whether a file begins with zeros. HDF5 has created it and not flushed it yet: it contains no row, because a run flushes its file before
/// the first one, and other blocks may be on disk before the superblock. Or a power cut has kept no first page.
bool is_blank(const std::string& path, std::size_t bytes) {
    const std::string head = head_of(path).substr(0, bytes);
    return !head.empty() && head.find_first_not_of('\0') == std::string::npos;
}

/// Version of the superblock that an HDF5 file begins with: 2 in states, 3 in records and tables; -1: no HDF5 file.
int hdf5_version(const std::string& path) {
    const std::string head = head_of(path);
    return head.size() > 8 && head.starts_with("\x89HDF\r\n\x1a\n") ? head[8] : -1;
}

/// Attribute `format` of a file; nothing if HDF5 cannot read it.
std::optional<std::string> format_of(const std::string& path) {
    try {
        return hdf5::format_of(path);
    } catch (const RecordError&) {
        return std::nullopt;
    }
}

/// Whether a file has rows of a run: what a killed one left. Unreadable files of HDF5 count as such; none that small can have rows.
bool holds_rows(const std::string& path) {
    constexpr std::uintmax_t most_without_rows = 8192;
    if (hdf5_version(path) != 3) return false;
    try {
        return RunReader(path).rows() > 0;
    } catch (const RecordError&) {
        std::error_code unknown;
        return !format_of(path) && fs::file_size(path, unknown) > most_without_rows;
    }
}

/// The descriptor that a shell gave this process, of a name that leads to it; -1: another name.
int descriptor_of(const std::string& path) {
    if (path == "/dev/stdout") return STDOUT_FILENO;
    if (path == "/dev/stderr") return STDERR_FILENO;
    for (const std::string_view folder : {"/dev/fd/", "/proc/self/fd/"}) {
        int number = -1;
        const char* end = path.data() + path.size();
        if (path.starts_with(folder) && std::from_chars(path.data() + folder.size(), end, number).ptr == end) return number;
    }
    return -1;
}

/// Whether a writer of texts takes the name as a shell's `>` does: a device or a pipe.
bool leads_to_device(const std::string& path) {
    struct stat file {};
    if (stat(path.c_str(), &file) != 0) return false;
    return descriptor_of(path) >= 0 || S_ISCHR(file.st_mode) || S_ISFIFO(file.st_mode);
}

void require_place(const std::string& path) {
    if (path.back() == '/') refuse_creation(path, "a folder, not a file");
    for (const char* suffix : {"", ".part"})
        if (const std::string other = other_than_file(path + suffix); !other.empty()) refuse_creation(path + suffix, other);
    if (const std::string missing = missing_folder(path); !missing.empty()) refuse_creation(path, missing);
    if (access(folder_of(path).c_str(), W_OK) != 0) refuse_creation(path, std::strerror(errno));
}

bool is_owned(const OutputRule& rule, const std::string& file) {
    try {
        return rule.own && rule.own(file);
    } catch (const std::runtime_error&) {
        return false;
    }
}

/// Checks a file that a killed writer may have left beside the name: the .part of its file, or the .before of a record that was being
/// continued. PartFile detects a live writer.
void require_free_part(const std::string& part, const OutputRule& rule) {
    std::error_code absent;
    if (rule.force || rule.former || !fs::exists(part, absent) || fs::file_size(part, absent) == 0) return;
    const bool rows = holds_rows(part);
    if (rows && !rule.repeats)
        throw RecordError(part + ": already exists: rows of a run that was killed (cvtflow info shows them); " + rule.advice);
    if (!rows && is_blank(part, rule.repeats ? superblock_bytes : head_bytes)) return;
    if (part.ends_with(".before")) return;  // only resume writes there, and it checks by itself
    if (is_owned(rule, part) || (!rows && hdf5_version(part) == 3 && format_of(part).value_or("cvtflow run") == "cvtflow run")) return;
    throw RecordError(part + ": already exists and is not a " + rule.what + "; " + rule.advice);
}

void require_own(const std::string& path, const OutputRule& rule) {
    if (rule.force || rule.former) return;
    if (rule.named) throw RecordError(path + ": already exists; " + rule.advice);
    if (!is_owned(rule, path)) throw RecordError(path + ": already exists and is not a " + rule.what + "; " + rule.advice);
    struct stat file {};
    const bool writable = stat(path.c_str(), &file) == 0 && (file.st_mode & 0222U) != 0 && access(path.c_str(), W_OK) == 0;
    if (!writable) throw RecordError(path + ": already exists and is write-protected; " + rule.advice);
}

}  // namespace

std::string folder_of(const std::string& path) {
    const std::string parent = fs::path(path).parent_path().string();
    return parent.empty() ? "." : parent;
}

std::string missing_folder(const std::string& path) {
    std::error_code unreadable;
    const std::string folder = folder_of(path);
    return fs::is_directory(folder, unreadable) ? "" : "the folder '" + folder + "' does not exist";
}

std::string other_than_file(const std::string& path) {
    struct stat file {};
    if (lstat(path.c_str(), &file) != 0 || S_ISREG(file.st_mode)) return "";
    if (S_ISLNK(file.st_mode)) return "a symbolic link; name its target";
    return S_ISDIR(file.st_mode) ? "a folder, not a file" : "a device, pipe or socket, not a file";
}

void require_no_input(const std::string& path, const std::vector<fs::path>& inputs) {
    for (const std::string& written : {path, path + ".part"}) {
        for (const fs::path& input : inputs) {
            std::error_code absent;
            if (input.empty() || !fs::equivalent(written, input, absent) || absent) continue;
            refuse_creation(path, (written == path ? "it" : "its .part") + std::string(" would replace the input ") + input.string());
        }
    }
}

namespace {

/// Identity of the file under a name, or of its absence; another file or other contents differ.
using Version = std::array<std::intmax_t, 5>;

Version version_of(const std::string& path) {
    struct stat file {};
    if (lstat(path.c_str(), &file) != 0) return {};
    return {static_cast<std::intmax_t>(file.st_dev), static_cast<std::intmax_t>(file.st_ino), file.st_size, file.st_mtim.tv_sec,
            file.st_mtim.tv_nsec};
}

/// Renames a file to a name that no file has. @return 0 or an errno
int rename_to_new(const std::string& from, const std::string& to) {
    if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
    if (errno != EINVAL && errno != ENOSYS) return errno;
    if (link(from.c_str(), to.c_str()) == 0) return unlink(from.c_str()) == 0 ? 0 : errno;
    if (errno == EEXIST) return errno;
    return std::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;  // a file system without links
}

}  // namespace

struct Permit::Seen {
    OutputRule rule;
    Version version;
};

Permit::Permit(const std::string& path, const OutputRule& rule) : path_(path) {
    if (path.empty()) return;
    require_no_input(path, rule.inputs);
    device_ = rule.devices && leads_to_device(path);
    if (device_) return;
    require_place(path);
    std::error_code absent;
    seen_ = std::make_shared<Seen>(Seen{rule, version_of(path)});
    replaces_ = fs::exists(path, absent);
    if (replaces_) require_own(path, rule);
    for (const char* suffix : {".part", ".before"})
        if (!being_written(path + suffix)) require_free_part(path + suffix, rule);
}

std::string Permit::notice() const { return replaces_ ? path_ + ": the existing file is replaced" : ""; }

bool Permit::may_take_name() const {
    const Version now = version_of(path_);
    if (now == Version{} || now == seen_->version) return true;
    const OutputRule& rule = seen_->rule;
    return other_than_file(path_).empty() && (rule.force || (rule.repeats && is_owned(rule, path_)));
}

void Permit::require_still() const {
    if (!may_take_name()) throw RecordError(path_ + ": cannot create: another program has written it meanwhile; " + seen_->rule.advice);
    require_free_part(path_ + ".part", seen_->rule);
}

void Permit::give_name(const std::string& complete) const {
    struct stat former {};
    const bool replaces = lstat(path_.c_str(), &former) == 0, may = may_take_name();
    if (replaces && may) static_cast<void>(chmod(complete.c_str(), former.st_mode & 07777U));
    int reason = EEXIST;
    if (may && !replaces) reason = rename_to_new(complete, path_);
    if (may && replaces) reason = std::rename(complete.c_str(), path_.c_str()) == 0 ? 0 : errno;
    if (reason == EEXIST)
        throw RecordError(path_ + ": another program has written it meanwhile and it stays; the file of this one is " + complete);
    if (reason != 0) throw RecordError(complete + ": cannot rename to '" + path_ + "': " + std::strerror(reason));
    seen_->version = version_of(path_);
}

IsOwn record_with(std::string attribute, std::string text) {
    return [attribute = std::move(attribute), text = std::move(text)](const std::string& file) {
        if (hdf5_version(file) != 3) return false;
        const RunReader reader(file);
        const auto* found = attribute_value<std::string>(reader.attributes(), attribute);
        return found != nullptr && *found == text;
    };
}

bool is_torn_record(const std::string& file) { return hdf5_version(file) == 3 && !format_of(file); }

bool is_state_file(const std::string& file) {
    if (hdf5_version(file) != 2) return false;
    const std::optional<std::string> format = format_of(file);
    return !format || *format == "cvtflow state";
}

IsOwn text_with(std::vector<std::string> marks) {
    return [marks = std::move(marks)](const std::string& file) {
        const std::string head = head_of(file);
        const auto is_there = [&head](const std::string& mark) { return head.find(mark) != std::string::npos; };
        return !marks.empty() && std::all_of(marks.begin(), marks.end(), is_there);
    };
}

namespace {

/// Opened without waiting for a reader; what a shell has opened is written where it stands, as the shell's `>` or `>>`.
void write_device(const std::string& path, std::string_view bytes) {
    const int given = descriptor_of(path);
    Descriptor device(given >= 0 ? fcntl(given, F_DUPFD_CLOEXEC, 0)
                                 : open(path.c_str(), O_WRONLY | O_TRUNC | O_NONBLOCK | O_CLOEXEC | O_NOCTTY));
    const auto fail = [&path](int reason) {
        throw RecordError(path + ": cannot write: " + (reason == ENXIO ? "no process reads from this pipe" : std::strerror(reason)));
    };
    if (device.number() < 0) fail(errno);
    if (given < 0) fcntl(device.number(), F_SETFL, fcntl(device.number(), F_GETFL) & ~O_NONBLOCK);
    while (!bytes.empty()) {
        const ssize_t count = ::write(device.number(), bytes.data(), bytes.size());
        if (count < 0 && errno != EINTR) fail(errno);
        bytes.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    }
    if (::close(device.give_away()) != 0) fail(errno);
}

}  // namespace

void write_whole(const Permit& permit, std::string_view bytes, bool durable) {
    if (permit.device()) return write_device(permit.path(), bytes);
    PartFile part(permit);
    part.require(part.write(bytes.data(), bytes.size()));
    part.publish(durable);
}

void sync_files_in(const std::string& folder) {
    const Descriptor open_folder(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (syncfs(open_folder.number()) != 0) throw RecordError(folder + ": cannot write to disk: " + std::strerror(errno));
}

void remove_own_files(const fs::path& folder, const std::function<bool(const fs::path& file)>& replaceable) {
    std::error_code ignored;
    if (!fs::is_directory(fs::symlink_status(folder, ignored))) return;
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
        if (fs::is_regular_file(entry.symlink_status(ignored)) && replaceable(entry.path())) files.push_back(entry.path());
    for (const fs::path& file : files) fs::remove(file, ignored);
    fs::remove(folder, ignored);  // only if it is empty
}

}  // namespace cvtflow::engine
