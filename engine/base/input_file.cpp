#include "engine/base/input_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

namespace cvtflow::engine {

namespace {

constexpr long system_of_pipes = 0x50495045;  ///< file system of pipes in Linux (PIPEFS_MAGIC)

[[noreturn]] void fail(int reason) { throw InputError(std::strerror(reason)); }

/// A file that is open for reading; never waits.
struct Opened {
    explicit Opened(const std::string& path) : file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)) {
        if (file.number() < 0 || fstat(file.number(), &about) != 0) fail(errno);
    }

    /// A pipe without a name has a writer, or had one: pipe(2) made both ends.
    [[nodiscard]] bool nameless_pipe() const {
        struct statfs system {};
        return S_ISFIFO(about.st_mode) && fstatfs(file.number(), &system) == 0 && system.f_type == system_of_pipes;
    }
    void require_regular() const {
        if (S_ISDIR(about.st_mode)) throw InputError("a folder, not a file");
        if (!S_ISREG(about.st_mode)) throw InputError("not a regular file");
    }

    Descriptor file;
    struct stat about {};
};

/// Reads up to `count` bytes; fewer only at the end, or of a pipe. @param offset in the file; negative: a pipe
std::size_t read_at(int descriptor, std::int64_t offset, std::byte* bytes, std::size_t count) {
    std::size_t done = 0;
    while (done < count) {
        const ssize_t some = offset < 0 ? ::read(descriptor, bytes + done, count - done)
                                        : pread(descriptor, bytes + done, count - done, offset + static_cast<off_t>(done));
        if (some < 0 && errno == EINTR) continue;
        if (some < 0) fail(errno);
        done += static_cast<std::size_t>(some);
        if (some == 0 || offset < 0) break;  // of a pipe what has come
    }
    return done;
}

}  // namespace

Descriptor::~Descriptor() {
    if (number_ >= 0) close(number_);
}

InputFile::InputFile(const std::string& path) {
    Opened opened(path);
    opened.require_regular();
    size_ = static_cast<std::uint64_t>(opened.about.st_size);
    descriptor_ = std::move(opened.file);
}

bool InputFile::same_as(int descriptor) const noexcept {
    struct stat here {
    }, there{};
    return fstat(descriptor_.number(), &here) == 0 && fstat(descriptor, &there) == 0 && here.st_dev == there.st_dev &&
           here.st_ino == there.st_ino;
}

std::size_t InputFile::read(std::uint64_t offset, std::byte* bytes, std::size_t count) const {
    return read_at(descriptor_.number(), static_cast<std::int64_t>(offset), bytes, count);
}

std::span<const EmbeddedFile> embedded_files() noexcept { return {}; }

std::string read_text_input(const std::string& path, std::uint64_t most) {
    const Opened opened(path);
    const bool pipe = opened.nameless_pipe();
    if (!pipe) opened.require_regular();
    if (pipe) fcntl(opened.file.number(), F_SETFL, 0);  // reading waits for the writer
    const std::string limit = std::to_string(most), size = std::to_string(opened.about.st_size);
    if (static_cast<std::uint64_t>(opened.about.st_size) > most)
        throw InputError(size + " bytes, more than the " + limit + " that such a file may have");
    std::string text;
    std::vector<std::byte> block(65536);  // not on the stack: threads of a host may have little
    const auto next = [&] {
        return read_at(opened.file.number(), pipe ? -1 : static_cast<std::int64_t>(text.size()), block.data(), block.size());
    };
    // Not by its size: files of /proc have none, and others may grow.
    for (std::size_t some = 0; (some = next()) > 0;) {
        text.append(reinterpret_cast<const char*>(block.data()), some);
        if (text.size() > most) throw InputError("more than the " + limit + " bytes that such a file may have");
    }
    if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
    return text;
}

FileIdentity identity_of(const std::string& path) noexcept {
    struct stat file {};
    if (stat(path.c_str(), &file) != 0) return {};
    return {file.st_dev, file.st_ino, file.st_size, file.st_mtim.tv_sec, file.st_mtim.tv_nsec, file.st_uid};
}

}  // namespace cvtflow::engine
