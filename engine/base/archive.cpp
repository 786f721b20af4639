#include "engine/base/archive.hpp"

#include "engine/base/hash.hpp"

namespace cvtflow::engine {

std::size_t Archive::heading(std::string_view name, ArchiveType type, std::size_t size, std::size_t count) {
    constexpr std::size_t around = 2 + sizeof(std::uint64_t);
    std::byte bytes[std::numeric_limits<std::uint8_t>::max() + around];
    bytes[0] = static_cast<std::byte>(name.size());
    std::memcpy(bytes + 1, name.data(), name.size());
    bytes[1 + name.size()] = static_cast<std::byte>(type);
    const std::size_t length = name.size() + around, named = length - sizeof(std::uint64_t);
    std::uint64_t stored = count;
    if (!reads()) {
        std::memcpy(bytes + named, &stored, sizeof stored);
        move(bytes, length);
        return count;
    }
    if (from_.size() < length || std::memcmp(from_.data(), bytes, named) != 0) refuse(name);
    std::memcpy(&stored, from_.data() + named, sizeof stored);
    if (stored > (from_.size() - length) / size) refuse(name);
    from_ = from_.subspan(length);
    return static_cast<std::size_t>(stored);
}

void Archive::refuse(std::string_view name) const { throw ArchiveError("it has no valid field '" + std::string(name) + "'"); }

void Archive::end() const {
    if (!from_.empty()) throw ArchiveError("it has further fields");
}

constexpr std::size_t word = sizeof(std::uint64_t), head = state_mark.size() + word;

std::vector<std::byte> state_of(const std::function<void(Archive&)>& visit, std::size_t expected_size) {
    std::vector<std::byte> state;
    state.reserve(expected_size);
    state.resize(head);
    std::memcpy(state.data(), state_mark.data(), state_mark.size());
    std::memcpy(state.data() + state_mark.size(), &state_version, word);
    Archive archive = Archive::to(state);
    visit(archive);
    const std::uint64_t sum = Checksum().add(state).value();
    state.resize(state.size() + word);
    std::memcpy(state.data() + state.size() - word, &sum, word);
    return state;
}

bool begins_with(std::span<const std::byte> bytes, std::string_view text) noexcept {
    return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

void require_state(std::span<const std::byte> bytes) {
    if (begins_with(bytes, hdf5_mark)) throw ArchiveError("an HDF5 file, not a state; if it is one of version 0.4, settle or run again");
    if (begins_with(bytes, "CVTFLOW") || begins_with(bytes, "CVTFMU")) throw ArchiveError("a state of version 0.4: settle or run again");
    if (bytes.size() < head || !begins_with(bytes, state_mark)) throw ArchiveError("not a state");
    std::uint64_t version = 0;
    std::memcpy(&version, bytes.data() + state_mark.size(), word);
    if (version != state_version)
        throw ArchiveError("a state of format " + std::to_string(version) + ", this program reads " + std::to_string(state_version));
}

std::span<const std::byte> fields_of_state(std::span<const std::byte> state) {
    require_state(state);
    std::uint64_t sum = 0;
    if (state.size() >= head + word) std::memcpy(&sum, state.data() + state.size() - word, word);
    if (state.size() < head + word || sum != Checksum().add(state.first(state.size() - word)).value())
        throw ArchiveError("a damaged state: its checksum differs");
    return state.subspan(head, state.size() - head - word);
}

}  // namespace cvtflow::engine
