#include "engine/record/table/torn_table.hpp"

#include <algorithm>
#include <cstring>

#include "engine/record/hdf5/file_seal.hpp"

namespace cvtflow::engine {
namespace {

constexpr std::size_t window_bytes = std::size_t{1} << 20U;

/// Shows every `width` bytes of a file that lie together, from its beginning on.
/// @param inspect  @return number of bytes to the next position; 0: end
template <class Inspect>
void walk(const InputFile& file, std::size_t width, const Inspect& inspect) {
    std::vector<std::byte> window(window_bytes + width);
    std::uint64_t from = 0;
    for (std::size_t read = 0; (read = file.read(from, window.data(), window.size())) >= width;) {
        std::size_t at = 0;
        while (at + width <= read) {
            const std::size_t further = inspect(std::span<const std::byte>(window).subspan(at, width));
            if (further == 0) return;
            at += further;
        }
        from += at;
    }
}

}  // namespace

bool torn_while_growing(const std::string& path, std::string_view text) {
    try {
        const InputFile file(path);
        if (text.empty() || inspect_seal(file) != Seal::none) return false;
        bool found = false;
        walk(file, text.size(), [&](std::span<const std::byte> bytes) -> std::size_t {
            found = std::memcmp(bytes.data(), text.data(), text.size()) == 0;
            return found ? 0 : 1;
        });
        return found;
    } catch (const InputError&) {
        return false;
    }
}

std::vector<std::byte> whole_rows(const std::string& path, const RowLayout& layout,
                                  const std::function<bool(std::span<const std::byte> row)>& plausible) {
    std::vector<std::byte> rows;
    try {
        walk(InputFile(path), layout.bytes(), [&](std::span<const std::byte> row) -> std::size_t {
            if (!plausible(row) || !layout.sound(row)) return 1;
            rows.insert(rows.end(), row.begin(), row.end());
            return row.size();
        });
    } catch (const InputError& error) {
        throw RecordError(path + ": " + error.what());
    }
    return rows;
}

}  // namespace cvtflow::engine
