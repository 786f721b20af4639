#pragma once
/// Files that are read: regular ones, of a size that can be meant. A pipe would be waited for, a device would never end.

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace cvtflow::engine {

/// what() is the reason alone: "No such file or directory", "a folder, not a file", "not a regular file", "5000000000 bytes, more than
/// the 67108864 that such a file may have", "Input/output error".
struct InputError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A regular file, open for reading.
class InputFile {
public:
    /// Never waits. @throws InputError
    explicit InputFile(const std::string& path);
    ~InputFile();
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;

    [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
    /// When it was opened [byte].
    [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
    /// Whether a descriptor is open on the same file.
    [[nodiscard]] bool same_as(int descriptor) const noexcept;
    /// Up to `count` bytes from `offset` on; fewer only at the file's end. @throws InputError
    [[nodiscard]] std::size_t read(std::uint64_t offset, std::byte* bytes, std::size_t count) const;

private:
    int descriptor_ = -1;
    std::uint64_t size_ = 0;
};

/// Most bytes of a text that a person has written, or a program for another one [byte].
inline constexpr std::uint64_t longest_text = std::uint64_t{64} << 20U;

/// All of a text, without a byte order mark at its beginning. @throws InputError
[[nodiscard]] std::string read_text_input(const std::string& path, std::uint64_t most = longest_text);

}  // namespace cvtflow::engine
