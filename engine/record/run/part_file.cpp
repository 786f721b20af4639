#include "engine/record/run/part_file.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "engine/record/hdf5/file_seal.hpp"
#include "engine/record/run/schema.hpp"

namespace cvtflow::engine {

namespace {

struct flock whole_file() {
    struct flock whole {};
    whole.l_type = F_WRLCK;
    whole.l_whence = SEEK_SET;
    return whole;
}

}  // namespace

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

namespace fs = std::filesystem;

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

PartFile::PartFile(const Permit& permit) : permit_(permit), final_path_(permit.path()), part_path_(final_path_ + ".part") {
    if (permit.empty()) throw RecordError("cannot create a temporary file");
    for (const std::string& path : {final_path_, part_path_})  // a link may have taken its place since it was permitted
        if (const std::string other = other_than_file(path); !other.empty()) throw RecordError(path + ": cannot create: " + other);
    descriptor_ = open_part(part_path_);
    const int part = descriptor_.number();
    if (part < 0) throw RecordError(part_path_ + ": cannot create: " + std::strerror(errno));
    if (!lock_file(part, part_path_) || !still_named(part, part_path_))
        throw RecordError(part_path_ + ": cannot create: another run is writing it");
    try {
        permit.require_still();
    } catch (const RecordError&) {
        struct stat created {};
        if (fstat(part, &created) == 0 && created.st_size == 0) discard();
        throw;
    }
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

void PartFile::publish(bool durable) {
    trim();
    if (!durable) return permit_.give_name(part_path_);
    if (const int reason = sync(); reason != 0) throw RecordError(part_path_ + ": cannot write to disk: " + std::strerror(reason));
    permit_.give_name(part_path_);
    // So that the new name survives a power cut; the data are safe already, so failure is no error.
    fsync(Descriptor(open(folder_of(final_path_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)).number());
}

namespace {

bool is_there(const std::string& path) {
    std::error_code ignored;
    return fs::exists(fs::symlink_status(path, ignored));
}

void require_at_rest(const std::string& path) {
    if (const std::string other = other_than_file(path); !other.empty()) throw RecordError(path + ": cannot be continued: " + other);
    // A run that was killed may have a child that tries a file for it, with the same locks, and ends a moment later.
    for (int wait = 0; wait < 50 && being_written(path); ++wait) usleep(10'000);
    if (being_written(path)) throw RecordError(path + ": cannot be continued: a run is still writing it");
}

/// Whether a file that lies in the way is the run's. @throws RecordError if it is not, and may not be replaced
bool is_former(const std::string& path, const FormerFiles& files) try {
    require_at_rest(path);
    if (files.own(path)) return true;
    if (!files.replace) throw RecordError(path + ": cannot be continued: not the record of this run; --force replaces it");
    return false;
} catch (const RecordError&) {
    if (!files.replace || being_written(path) || !other_than_file(path).empty()) throw;
    return false;
}

bool yields(const std::string& path, const FormerFiles& files) try {
    return other_than_file(path).empty() && files.yields(path);
} catch (const RecordError&) {
    return false;
}

}  // namespace

std::string set_aside(const std::string& path, const FormerFiles& files) {
    const std::string before = path + ".before";
    std::string found;
    for (const std::string& left : {before, path + ".part", path}) {
        if (!is_there(left)) continue;
        if (left == path && !found.empty() && yields(left, files)) continue;
        if (left == path + ".part" && !found.empty()) {
            require_at_rest(left);
            continue;  // of the attempt that was killed, or of a run that would have found .before
        }
        if (is_former(left, files) && found.empty()) found = left;
    }
    if (found.empty() || found == before) return found;
    if (std::rename(found.c_str(), before.c_str()) != 0)
        throw RecordError(found + ": cannot rename to '" + before + "': " + std::strerror(errno));
    return before;
}

void PartFile::discard() noexcept { unlink(part_path_.c_str()); }

void PartFile::require(int reason) {
    if (reason == 0) return;
    discard();
    throw RecordError(final_path_ + ": cannot write: " + std::strerror(reason));
}

}  // namespace cvtflow::engine
