#include "engine/base/text_file.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace cvtflow::engine {

namespace {

[[noreturn]] void fail(int reason) { throw std::runtime_error(std::strerror(reason)); }

/// Waits for bytes or their end: a pipe without a writer would keep read() for ever.
void await(int descriptor, double patience) {
    pollfd wish{descriptor, POLLIN, 0};
    const int ready = poll(&wish, 1, static_cast<int>(1e3 * patience));
    if (ready < 0 && errno != EINTR) fail(errno);
    if (ready == 0) throw std::runtime_error("nothing came for " + std::to_string(static_cast<long>(patience)) + " s");
}

struct Descriptor {
    explicit Descriptor(const std::string& path) : number(open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
        if (number < 0) fail(errno);
    }
    ~Descriptor() { ::close(number); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int number;
};

}  // namespace

std::string read_text_file(const std::string& path, std::size_t most, double patience) {
    const Descriptor file(path);
    struct stat about {};
    if (fstat(file.number, &about) != 0) fail(errno);
    if (S_ISDIR(about.st_mode)) fail(EISDIR);
    std::string text;
    char block[65536];
    for (;;) {
        if (!S_ISREG(about.st_mode)) await(file.number, patience);
        const ssize_t count = ::read(file.number, block, sizeof block);
        if (count == 0) return text;
        if (count < 0 && errno != EINTR && errno != EAGAIN) fail(errno);
        if (count > 0) text.append(block, static_cast<std::size_t>(count));
        if (text.size() > most) throw std::runtime_error("longer than " + std::to_string(most) + " bytes");
    }
}

}  // namespace cvtflow::engine
