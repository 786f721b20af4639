#include "engine/record/run/state_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

namespace cvtflow::engine {
namespace {

/// With the standard library alone: the core library reads states, too. @param most  bytes
std::vector<std::byte> first_bytes(const std::string& path, std::uintmax_t most) {
    namespace fs = std::filesystem;
    std::error_code unknown;
    if (fs::is_directory(path, unknown)) throw RecordError(path + ": a folder, not a file");
    if (fs::exists(path, unknown) && !fs::is_regular_file(path, unknown)) throw RecordError(path + ": not a regular file");
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    if (!file) throw RecordError(path + ": " + std::strerror(errno));
    std::vector<std::byte> bytes(static_cast<std::size_t>(std::min(most, fs::file_size(path, unknown))));
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(file.gcount()));
    return bytes;
}

}  // namespace

bool is_state_file(const std::string& file) {
    try {
        const std::vector<std::byte> head = first_bytes(file, state_mark.size());
        return begins_with(head, state_mark) || std::ranges::none_of(head, [](std::byte each) { return each != std::byte{0}; });
    } catch (const RecordError&) {
        return false;
    }
}

void read_state_file(const std::string& path, std::string_view kind, const std::function<void(Archive&)>& visit) {
    std::string problem = path + ": ";
    try {
        require_state(first_bytes(path, 2 * sizeof(std::uint64_t)));  // no other file is read as a whole
        const std::vector<std::byte> bytes = first_bytes(path, std::numeric_limits<std::uintmax_t>::max());
        Archive archive = Archive::from(fields_of_state(bytes));
        problem += "a state, but not a " + std::string(kind) + ": ";
        visit(archive);
    } catch (const ArchiveError& error) {
        throw RecordError(problem + error.what());
    }
}

SavedState read_state(const std::string& path) {
    if (begins_with(first_bytes(path, hdf5_mark.size()), hdf5_mark)) return last_state_of_record(path);
    SavedState saved;
    read_state_file(path, "start", [&](Archive& archive) { saved.visit(archive); });
    return saved;
}

}  // namespace cvtflow::engine
