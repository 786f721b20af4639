#include <cstring>

#include "api/fmi/instance.hpp"
#include "engine/base/hash.hpp"

namespace cvtflow::fmi {

namespace {

constexpr std::string_view magic = "CVTFMU02";

class Bytes {
public:
    explicit Bytes(std::span<const std::byte> rest) : rest_(rest) {}
    [[nodiscard]] std::span<const std::byte> take(std::size_t size) {
        if (rest_.size() < size) throw Error(ErrorCode::state, "saved state of an FMU: truncated");
        const auto taken = rest_.first(size);
        rest_ = rest_.subspan(size);
        return taken;
    }
    template <class T>
    [[nodiscard]] T value() {
        T value;
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }
    [[nodiscard]] std::span<const std::byte> rest() const noexcept { return rest_; }

private:
    std::span<const std::byte> rest_;
};

template <class T>
void add(std::vector<std::byte>& bytes, const T& value) {
    const auto* from = reinterpret_cast<const std::byte*>(&value);
    bytes.insert(bytes.end(), from, from + sizeof value);
}

}  // namespace

std::vector<std::byte> Snapshot::bytes() const {
    std::vector<std::byte> bytes;
    for (const char letter : magic) add(bytes, letter);
    add(bytes, start);
    add(bytes, now);
    add(bytes, static_cast<std::uint64_t>(ready));
    add(bytes, static_cast<std::uint64_t>(parameters.size()));
    for (const auto& [key, value] : parameters) {
        add(bytes, static_cast<std::uint64_t>(key.size()));
        for (const char letter : key) add(bytes, letter);
        add(bytes, value);
    }
    add(bytes, engine::Hash().add(std::span<const std::byte>(bytes)).value());  // the state has its own
    bytes.insert(bytes.end(), state.bytes().begin(), state.bytes().end());
    return bytes;
}

Snapshot Snapshot::from_bytes(std::span<const std::byte> bytes) {
    Bytes rest(bytes);
    if (std::memcmp(rest.take(magic.size()).data(), magic.data(), magic.size()) != 0)
        throw Error(ErrorCode::state, "saved state of an FMU: malformed");
    Snapshot made;
    made.start = rest.value<double>();
    made.now = rest.value<double>();
    made.ready = rest.value<std::uint64_t>() != 0;
    for (auto left = rest.value<std::uint64_t>(); left > 0; --left) {
        const auto letters = rest.take(rest.value<std::uint64_t>());
        const std::string key(reinterpret_cast<const char*>(letters.data()), letters.size());
        made.parameters[key] = rest.value<double>();
    }
    const std::uint64_t header = engine::Hash().add(bytes.first(bytes.size() - rest.rest().size())).value();
    if (rest.value<std::uint64_t>() != header) throw Error(ErrorCode::state, "saved state of an FMU: it is damaged");
    made.state = State::from_bytes(rest.rest());
    return made;
}

}  // namespace cvtflow::fmi
