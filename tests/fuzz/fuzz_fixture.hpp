#pragma once
/// Input of fuzz targets as a file, and as text.

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace cvtflow::fuzz {

/// Bytes as a regular file in memory, for readers that want a path.
class MemoryFile {
public:
    MemoryFile(const std::uint8_t* bytes, std::size_t size) : descriptor_(memfd_create("input", MFD_CLOEXEC)) {
        for (std::size_t done = 0; done < size;) {
            const ssize_t some = write(descriptor_, bytes + done, size - done);
            if (some <= 0) break;
            done += static_cast<std::size_t>(some);
        }
    }
    ~MemoryFile() { close(descriptor_); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

private:
    int descriptor_;
};

inline std::string_view text_of(const std::uint8_t* bytes, std::size_t size) { return {reinterpret_cast<const char*>(bytes), size}; }

}  // namespace cvtflow::fuzz
