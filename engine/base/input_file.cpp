#include "engine/base/input_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace cvtflow::engine {

InputFile::InputFile(const std::string& path) : descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)) {
    if (descriptor_ < 0) throw InputError(std::strerror(errno));
    struct stat file {};
    const char* wrong = fstat(descriptor_, &file) != 0 ? std::strerror(errno) : S_ISDIR(file.st_mode) ? "a folder, not a file" : S_ISREG(file.st_mode) ? nullptr : "not a regular file";
    if (wrong != nullptr) {
        close(descriptor_);
        throw InputError(wrong);
    }
    size_ = static_cast<std::uint64_t>(file.st_size);
}

InputFile::~InputFile() { close(descriptor_); }

bool InputFile::same_as(int descriptor) const noexcept {
    struct stat here {}, there {};
    return fstat(descriptor_, &here) == 0 && fstat(descriptor, &there) == 0 && here.st_dev == there.st_dev && here.st_ino == there.st_ino;
}

std::size_t InputFile::read(std::uint64_t offset, std::byte* bytes, std::size_t count) const {
    std::size_t done = 0;
    while (done < count) {
        const ssize_t some = pread(descriptor_, bytes + done, count - done, static_cast<off_t>(offset + done));
        if (some < 0 && errno == EINTR) continue;
        if (some < 0) throw InputError(std::strerror(errno));
        if (some == 0) break;
        done += static_cast<std::size_t>(some);
    }
    return done;
}

std::string read_text_input(const std::string& path, std::uint64_t most) {
    const InputFile file(path);
    if (file.size() > most) throw InputError(std::to_string(file.size()) + " bytes, more than the " + std::to_string(most) + " that such a file may have");
    std::string text;
    std::byte block[16384];
    // Not by its size: files of /proc have none, and others may grow.
    for (std::size_t some = 0; (some = file.read(text.size(), block, sizeof block)) > 0;) {
        text.append(reinterpret_cast<const char*>(block), some);
        if (text.size() > most) throw InputError("more than the " + std::to_string(most) + " bytes that such a file may have");
    }
    if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
    return text;
}

}  // namespace cvtflow::engine
