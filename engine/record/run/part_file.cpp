#include "engine/record/run/part_file.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "engine/record/hdf5/file_seal.hpp"
#include "engine/record/run/schema.hpp"

namespace cvtflow::engine {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_creation(const std::string& path, const std::string& why) { throw RecordError(path + ": cannot create: " + why); }

std::string folder_of(const std::string& path) {
    const std::string parent = fs::path(path).parent_path().string();
    return parent.empty() ? "." : parent;
}

/// Renames a file to a name that no file has. @return 0 or an errno
int rename_to_new(const std::string& from, const std::string& to) {
    if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
    if (errno != EINVAL && errno != ENOSYS) return errno;
    if (link(from.c_str(), to.c_str()) == 0) return unlink(from.c_str()) == 0 ? 0 : errno;
    if (errno == EEXIST) return errno;
    return std::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;  // a file system without links
}

struct flock whole_file() {
    struct flock whole {};
    whole.l_type = F_WRLCK;
    whole.l_whence = SEEK_SET;
    return whole;
}

}  // namespace

MayReplace any_file(bool force) {
    return [force](const std::string&) { return force; };
}

bool OutputFile::replaces(const std::string& there) const try { return may_replace && may_replace(there); } catch (const RecordError&) {
    return false;
}

std::string other_than_file(const std::string& path) {
    struct stat file {};
    if (lstat(path.c_str(), &file) != 0 || S_ISREG(file.st_mode)) return "";
    if (S_ISLNK(file.st_mode)) return "a symbolic link; name its target";
    return S_ISDIR(file.st_mode) ? "a folder, not a file" : "a device, pipe or socket, not a file";
}

std::string missing_folder(const std::string& path) {
    std::error_code unreadable;
    const std::string folder = folder_of(path);
    return fs::is_directory(folder, unreadable) ? "" : "the folder '" + folder + "' does not exist";
}

std::string head_of(const std::string& path) {
    std::string head(4096, '\0');
    try {
        head.resize(InputFile(path).read(0, reinterpret_cast<std::byte*>(head.data()), head.size()));
        return head;
    } catch (const InputError&) {
        return {};
    }
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

void require_place(const OutputFile& file, const std::vector<fs::path>& inputs) {
    const std::string &path = file.path, part = path + ".part";
    if (path.empty()) return;
    require_no_input(path, inputs);
    if (path.back() == '/') refuse_creation(path, "a folder, not a file");
    for (const std::string& there : {path, part})
        if (const std::string other = other_than_file(there); !other.empty()) refuse_creation(there, other);
    if (const std::string missing = missing_folder(path); !missing.empty()) refuse_creation(path, missing);
    if (access(folder_of(path).c_str(), W_OK) != 0) refuse_creation(path, std::strerror(errno));
    struct stat found {};
    if (lstat(path.c_str(), &found) == 0 && !file.replaces(path)) throw RecordError(path + ": already exists; " + file.advice);
    if (being_written(part)) refuse_creation(part, writer_of(part) + " is writing it");
    const bool left = lstat(part.c_str(), &found) == 0;
    if (!left && errno != ENOENT) refuse_creation(part, std::strerror(errno));
    if (left && found.st_size > 0 && !file.replaces(part))
        throw RecordError(part + ": already exists, left by a command that was killed (cvtflow info shows the rows of a run); " +
                          file.advice);
}

void give_name(const std::string& complete, const OutputFile& file) {
    int reason = rename_to_new(complete, file.path);
    if (reason == EEXIST) {
        struct stat there {};
        if (!other_than_file(file.path).empty() || lstat(file.path.c_str(), &there) != 0 || !file.replaces(file.path))
            throw RecordError(file.path + ": another program has written it meanwhile and it stays; the file of this one is " + complete);
        static_cast<void>(chmod(complete.c_str(), there.st_mode & 07777U));
        reason = std::rename(complete.c_str(), file.path.c_str()) == 0 ? 0 : errno;
    }
    if (reason != 0) throw RecordError(complete + ": cannot rename to '" + file.path + "': " + std::strerror(reason));
}

void write_whole(const OutputFile& file, std::string_view bytes) {
    PartFile part(file);
    part.require(part.write(bytes.data(), bytes.size()));
    part.publish();
}

/// An open-file-description lock: gone with the process, however it ends, and unseen by HDF5, which asks for flock locks.
bool lock_file(int descriptor, const std::string& path) {
    struct flock whole = whole_file();
    int result = 0;
    do {
        result = fcntl(descriptor, F_OFD_SETLK, &whole);
    } while (result != 0 && errno == EINTR);
    if (result == 0) return true;
    if (errno == EAGAIN || errno == EACCES) return false;
    throw RecordError(path + ": cannot lock: " + std::strerror(errno) +
                      "; without a lock, two runs could write into it; use another file system");
}

namespace {

/// Whether the path still names the file that is open; not so if another writer has just finished and renamed it.
bool still_named(int descriptor, const std::string& path) {
    struct stat open_file {};
    struct stat named_file {};
    return fstat(descriptor, &open_file) == 0 && stat(path.c_str(), &named_file) == 0 && open_file.st_ino == named_file.st_ino &&
           open_file.st_dev == named_file.st_dev;
}

/// A new file, or the plain one that a killed run left: never through a link, and none that has a second name elsewhere. @return none,
/// and errno
Descriptor open_part(const std::string& path) {
    constexpr int flags = O_RDWR | O_NOFOLLOW | O_CLOEXEC;
    Descriptor part(open(path.c_str(), flags | O_CREAT | O_EXCL, 0666));
    if (part.number() >= 0 || errno != EEXIST) return part;
    part = Descriptor(open(path.c_str(), flags));
    struct stat file {};
    if (part.number() < 0 || (fstat(part.number(), &file) == 0 && S_ISREG(file.st_mode) && file.st_nlink <= 1)) return part;
    part = Descriptor();
    errno = EEXIST;
    return part;
}

}  // namespace

bool being_written(const std::string& path) {
    const Descriptor descriptor(open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOFOLLOW));
    struct flock whole = whole_file();
    return descriptor.number() >= 0 && fcntl(descriptor.number(), F_OFD_GETLK, &whole) == 0 && whole.l_type != F_UNLCK;
}

std::string writer_of(const std::string& path) {
    std::error_code hidden;
    const fs::path file = fs::weakly_canonical(path, hidden);
    for (const fs::directory_entry& process : fs::directory_iterator("/proc", hidden)) {
        const std::string number = process.path().filename().string();
        if (number.find_first_not_of("0123456789") != std::string::npos) continue;  // also "self"
        std::error_code denied;
        for (fs::directory_iterator open(process.path() / "fd", denied), end; !denied && open != end; open.increment(denied))
            if (fs::read_symlink(open->path(), hidden) == file) return "process " + number;
    }
    return "another process";
}

PartFile::PartFile(const OutputFile& file, bool continues) : file_(file), part_path_(file.path + (continues ? ".part.part" : ".part")) {
    if (file.empty()) throw RecordError("cannot create a temporary file");
    if (!continues) require_place(file);
    descriptor_ = open_part(part_path_);
    const int part = descriptor_.number();
    if (part < 0) refuse_creation(part_path_, std::strerror(errno));
    if (!lock_file(part, part_path_) || !still_named(part, part_path_))
        refuse_creation(part_path_, writer_of(part_path_) + " is writing it");
    if (ftruncate(part, 0) != 0) throw RecordError(part_path_ + ": cannot empty: " + std::strerror(errno));
}

int PartFile::reserve(std::size_t end) noexcept {
    rlimit limit{};
    if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && end > limit.rlim_cur) return EFBIG;
    if (end <= reserved_) return 0;
    // Large steps keep the file in few pieces; if they do not fit any more, what is needed may still.
    constexpr std::size_t step = std::size_t{4} << 20U;
    for (const std::size_t target : {end + step, end}) {
        if (fallocate(descriptor_.number(), FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(target)) == 0) {
            reserved_ = target;
            return 0;
        }
        if (errno == EOPNOTSUPP || errno == ENOSYS) return 0;
    }
    return errno;
}

int PartFile::write(const void* bytes, std::size_t size) noexcept {
    return write_at(descriptor_.number(), 0, {static_cast<const std::byte*>(bytes), size});
}

int PartFile::seal() noexcept {
    struct stat file {};
    return fstat(descriptor_.number(), &file) != 0 ? errno : write_seal(descriptor_.number(), static_cast<std::uint64_t>(file.st_size));
}

int PartFile::sync() noexcept { return fsync(descriptor_.number()) == 0 ? 0 : errno; }

void PartFile::trim() noexcept {
    struct stat file {};
    if (reserved_ > 0 && fstat(descriptor_.number(), &file) == 0 && ftruncate(descriptor_.number(), file.st_size) == 0) reserved_ = 0;
}

void PartFile::take_place() {
    const std::string part = file_.path + ".part";
    if (std::rename(part_path_.c_str(), part.c_str()) != 0)
        throw RecordError(part_path_ + ": cannot rename to '" + part + "': " + std::strerror(errno));
    part_path_ = part;
}

void PartFile::publish(bool durable) {
    trim();
    if (const int reason = durable ? sync() : 0; reason != 0)
        throw RecordError(part_path_ + ": cannot write to disk: " + std::strerror(reason));
    give_name(part_path_, file_);
    // So that the new name survives a power cut; the data are safe already, so failure is no error.
    if (durable) fsync(Descriptor(open(folder_of(file_.path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)).number());
}

void PartFile::discard() noexcept { unlink(part_path_.c_str()); }

void PartFile::require(int reason) {
    if (reason == 0) return;
    discard();
    throw RecordError(file_.path + ": cannot write: " + std::strerror(reason));
}

}  // namespace cvtflow::engine
