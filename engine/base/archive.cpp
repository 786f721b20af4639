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
    return stored;
}

void Archive::refuse(std::string_view name) const { throw ArchiveError("it has no valid field '" + std::string(name) + "'"); }

void Archive::end() const {
    if (!from_.empty()) throw ArchiveError("it has further fields");
}

void begin_state(std::vector<std::byte>& state) {
    const auto mark = std::as_bytes(std::span(state_mark)), version = std::as_bytes(std::span(&state_version, 1));
    state.assign(mark.begin(), mark.end());
    state.insert(state.end(), version.begin(), version.end());
}

void seal_state(std::vector<std::byte>& state) {
    const std::uint64_t sum = Checksum().add(state).value();
    const auto bytes = std::as_bytes(std::span(&sum, 1));
    state.insert(state.end(), bytes.begin(), bytes.end());
}

bool begins_with(std::span<const std::byte> bytes, std::string_view text) noexcept {
    return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

std::span<const std::byte> fields_of_state(std::span<const std::byte> state) {
    constexpr std::size_t word = sizeof(std::uint64_t), head = state_mark.size() + word;
    for (const std::string_view former : {"CVTFLOW", "CVTFMU", "\x89HDF"})
        if (begins_with(state, former)) throw ArchiveError("it is not a state of this version, but of 0.4 or before: write it again");
    if (state.size() < head + word || !begins_with(state, state_mark)) throw ArchiveError("it is not a state");
    std::uint64_t version = 0, sum = 0;
    std::memcpy(&version, state.data() + state_mark.size(), word);
    if (version != state_version)
        throw ArchiveError("it is a state of format " + std::to_string(version) + ", this program reads " + std::to_string(state_version));
    std::memcpy(&sum, state.data() + state.size() - word, word);
    if (sum != Checksum().add(state.first(state.size() - word)).value()) throw ArchiveError("it is damaged");
    return state.subspan(head, state.size() - head - word);
}

}  // namespace cvtflow::engine
