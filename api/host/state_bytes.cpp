#include "api/host/state_bytes.hpp"

#include <string_view>
#include <type_traits>

#include "engine/base/hash.hpp"

namespace cvtflow::api {

namespace {

constexpr std::string_view magic = "CVTFLOW7";

[[noreturn]] void reject(const char* why) { throw Error(ErrorCode::state, std::string("saved state: ") + why); }

/// Type whose bytes represent a value: a `long` has 64 bits on every system.
template <class T>
using Stored = std::conditional_t<std::is_same_v<T, long>, std::int64_t, T>;

/// Whether a sequence of values is stored as it lies in memory.
template <class T>
inline constexpr bool is_stored_as_it_is = std::is_trivially_copyable_v<T> && !std::is_pointer_v<T> && std::is_same_v<T, Stored<T>>;

/// Writes from a place on; nullptr: only counts.
class Writer {
public:
    explicit Writer(std::byte* to) : to_(to) {}

    template <class T>
    void operator()(const T& value) {
        static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>);
        const Stored<T> stored = value;
        put(&stored, sizeof stored);
    }
    void operator()(const std::optional<double>& value) {
        (*this)(static_cast<std::uint8_t>(value.has_value()));
        (*this)(value.value_or(0.0));
    }
    template <class T>
    void operator()(const std::vector<T>& values) {
        static_assert(is_stored_as_it_is<T>);
        (*this)(static_cast<std::uint64_t>(values.size()));
        put(values.data(), values.size() * sizeof(T));
    }
    [[nodiscard]] std::size_t size() const noexcept { return size_; }

private:
    void put(const void* from, std::size_t bytes) {
        if (to_ != nullptr && bytes > 0) std::memcpy(to_ + size_, from, bytes);
        size_ += bytes;
    }

    std::byte* to_;
    std::size_t size_ = 0;
};

class Reader {
public:
    explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes, "saved state: it ends too early") {}

    template <class T>
    void operator()(T& value) {
        value = static_cast<T>(bytes_.value<Stored<T>>());
    }
    void operator()(bool& value) {
        const auto byte = bytes_.value<std::uint8_t>();
        if (byte > 1) reject("it contains an invalid flag");
        value = byte != 0;
    }
    void operator()(std::optional<double>& value) {
        const bool given = bytes_.value<std::uint8_t>() != 0;
        const auto number = bytes_.value<double>();
        value = given ? std::optional(number) : std::nullopt;
    }
    template <class T>
    void operator()(std::vector<T>& values) {
        static_assert(is_stored_as_it_is<T>);
        const auto size = bytes_.value<std::uint64_t>();
        if (size > bytes_.rest().size() / sizeof(T)) reject("a length is too large");
        values.resize(size);
        const auto from = bytes_.take(size * sizeof(T));
        if (size > 0) std::memcpy(values.data(), from.data(), from.size());
    }
    [[nodiscard]] bool empty() const noexcept { return bytes_.rest().empty(); }

private:
    UnreadBytes bytes_;
};

/// Visits every field once, for writing and reading alike.
template <class Stream, class Number, class Held, class Integration>
void visit(Stream& stream, Number& fingerprint, Held& held, Integration& integration) {
    stream(fingerprint);
    for (auto& value : held.values.value) stream(value);
    for (auto& reference : held.reference) {
        for (auto* number : {&reference.since, &reference.angle, &reference.zero}) stream(*number);
    }
    stream(held.coupled);
    auto field = [&](const char* /*name*/, auto& value) { stream(value); };
    tasks::visit_fields(integration, field);
}

[[nodiscard]] std::uint64_t checksum(std::span<const std::byte> bytes) { return engine::Checksum().add(bytes).value(); }

}  // namespace

std::uint64_t fingerprint(const tasks::Scene& scene) {
    tasks::Scene plain = scene;
    const tasks::RunSettings defaults;
    plain.name = plain.description = plain.state_file = "";
    plain.run = defaults;
    plain.run.method = method_of(scene);
    plain.run.step = scene.run.step;
    plain.run.output_interval = scene.run.output_interval;
    return engine::Hash().add(std::string_view(tasks::write_scene(plain))).value();
}

std::vector<std::byte> write_state_bytes(std::uint64_t fingerprint, const model::HeldInputs& held,
                                         const tasks::IntegrationState& integration) {
    const auto write = [&](Writer writer) {
        for (const char letter : magic) writer(letter);
        visit(writer, fingerprint, held, integration);
        return writer.size();
    };
    const std::size_t size = write(Writer(nullptr));
    std::vector<std::byte> bytes(size + sizeof(std::uint64_t));
    write(Writer(bytes.data()));
    Writer(bytes.data() + size)(checksum(std::span(bytes).first(size)));
    return bytes;
}

void check_state_bytes(std::span<const std::byte> bytes) {
    const std::size_t frame = magic.size() + sizeof(std::uint64_t);
    if (bytes.size() < frame || std::memcmp(bytes.data(), magic.data(), magic.size()) != 0) reject("it is not a state of this version");
    std::uint64_t written = 0;
    std::memcpy(&written, bytes.data() + bytes.size() - sizeof written, sizeof written);
    if (written != checksum(bytes.first(bytes.size() - sizeof written))) reject("it is damaged");
}

StateRecord read_state_bytes(std::span<const std::byte> bytes) {
    check_state_bytes(bytes);
    Reader reader(bytes.subspan(magic.size(), bytes.size() - magic.size() - sizeof(std::uint64_t)));
    StateRecord record;
    visit(reader, record.fingerprint, record.held, record.integration);
    if (!reader.empty()) reject("it has trailing bytes");
    return record;
}

}  // namespace cvtflow::api
