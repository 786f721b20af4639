#pragma once
/// Files that are read: regular ones, of a size that can be meant. A pipe that lies in a folder would be waited for, a device would never
/// end.

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace cvtflow::engine {

/// what() is the reason alone: "No such file or directory", "a folder, not a file", "not a regular file", "5000000000 bytes, more than
/// the 67108864 that such a file may have", "Input/output error".
struct InputError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A file's descriptor, closed when the scope ends, unless it is given away.
class Descriptor {
public:
    explicit Descriptor(int number = -1) noexcept : number_(number) {}
    ~Descriptor();
    Descriptor(Descriptor&& other) noexcept : number_(other.give_away()) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(number_, other.number_);
        return *this;
    }
    /// Negative: none.
    [[nodiscard]] int number() const noexcept { return number_; }
    [[nodiscard]] int give_away() noexcept { return std::exchange(number_, -1); }

private:
    int number_;
};

/// A regular file, open for reading.
class InputFile {
public:
    /// Opens the file without waiting. @throws InputError
    explicit InputFile(const std::string& path);

    [[nodiscard]] int descriptor() const noexcept { return descriptor_.number(); }
    /// Size when the file was opened [byte].
    [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
    /// Whether a descriptor is open on the same file.
    [[nodiscard]] bool same_as(int descriptor) const noexcept;
    /// Reads up to `count` bytes from `offset` on; fewer only at the file's end. @throws InputError
    [[nodiscard]] std::size_t read(std::uint64_t offset, std::byte* bytes, std::size_t count) const;

private:
    Descriptor descriptor_;
    std::uint64_t size_ = 0;
};

/// Identity of a file: device, number, size, time of change and owner.
struct FileIdentity {
    std::uint64_t device = 0, number = 0;
    std::int64_t size = 0, seconds = 0, nanoseconds = 0;
    std::uint64_t owner = 0;
    bool operator==(const FileIdentity&) const = default;
};
/// All zeros for a file that is not there.
[[nodiscard]] FileIdentity identity_of(const std::string& path) noexcept;

/// A text that is part of the library itself.
struct EmbeddedFile {
    std::string_view name, text;
};
/// The core library contains the ready scenes and their tables, and reads no other files. Other libraries contain none.
[[nodiscard]] std::span<const EmbeddedFile> embedded_files() noexcept;
/// Folder in the paths of embedded files: "ready:/shift.toml".
inline constexpr std::string_view embedded_folder = "ready:";

/// All of a text, without a byte order mark at its beginning. It may also come through a pipe without a name (`… | cvtflow check
/// /dev/stdin`, `<(…)`), for whose writer it waits.
/// @param most longest text [byte]
/// @throws InputError
[[nodiscard]] std::string read_text_input(const std::string& path, std::uint64_t most);

}  // namespace cvtflow::engine
