#pragma once
/// Named fields of a state as bytes. A class lists its fields once, for writing and for reading:
///
///     void Filter::visit(engine::Archive& archive) {
///         archive("filter_mean", mean_);    // a number, a flag, a text, or an array of numbers
///         archive("filter_steps", steps_);
///         if (archive.reads()) wrap(mean_);
///     }
///
/// A field is the length of its name (1 byte), the name, the type of its values (1 byte, see ArchiveType), their count (8 bytes) and the
/// values, without gaps, little-endian. Whoever reads asks for the same names in the same order.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace cvtflow::engine {

static_assert(std::endian::native == std::endian::little && std::numeric_limits<double>::is_iec559);

/// Bytes are no archive of the fields that are read from it. what() is one sentence for users.
struct ArchiveError : std::invalid_argument {
    using std::invalid_argument::invalid_argument;
};

/// Types of values, as the letters of Python's `struct` and NumPy.
enum class ArchiveType : char { real = 'd', single = 'f', count = 'q', word = 'Q', byte = 'B' };

class Archive {
public:
    /// Appends fields to bytes, which outlive it.
    [[nodiscard]] static Archive to(std::vector<std::byte>& bytes) noexcept { return {&bytes, {}}; }
    /// Reads fields from the beginning of bytes, which outlive it.
    [[nodiscard]] static Archive from(std::span<const std::byte> bytes) noexcept { return {nullptr, bytes}; }

    [[nodiscard]] bool reads() const noexcept { return to_ == nullptr; }
    /// Bytes that have not been read.
    [[nodiscard]] std::span<const std::byte> rest() const noexcept { return from_; }
    /// Ends reading. @throws ArchiveError if fields are left
    void end() const;
    /// Refuses what was read. @throws ArchiveError
    [[noreturn]] void refuse(std::string_view name) const;

    /// One field. Arrays, spans and structs of doubles keep their size; texts, vectors and optional numbers take the written one.
    /// @throws ArchiveError if another field is there, of another type or size
    template <class T>
    void operator()(std::string_view name, T&& value) {
        using Value = std::remove_cvref_t<T>;
        if constexpr (std::is_same_v<Value, bool>) {
            as<std::uint8_t>(name, value, 0, 1);
        } else if constexpr (std::is_integral_v<Value> && std::is_signed_v<Value>) {
            as<std::int64_t>(name, value, std::numeric_limits<Value>::min(), std::numeric_limits<Value>::max());
        } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
            double number = value.value_or(0.0);
            const std::size_t count = heading(name, ArchiveType::real, sizeof number, value ? 1 : 0);
            if (count > 1) refuse(name);
            move(&number, count * sizeof number);
            if (reads()) value = count == 1 ? std::optional(number) : std::nullopt;
        } else if constexpr (requires { value.resize(std::size_t{0}); }) {
            using Item = typename Value::value_type;
            const std::size_t each = sizeof(Item) / sizeof(NumberOf<Item>);
            const std::size_t count = heading(name, type_of<NumberOf<Item>>(), sizeof(NumberOf<Item>), value.size() * each);
            if (count % each != 0) refuse(name);
            if (reads()) value.resize(count / each);
            move(value.data(), count * sizeof(NumberOf<Item>));
        } else if constexpr (requires { std::span(value); }) {
            fixed(name, std::span(value));
        } else {
            fixed(name, std::span(&value, 1));
        }
    }
    /// A whole number. @throws ArchiveError as above, or where the one that is read is not one of first … last
    void operator()(std::string_view name, int& value, int first, int last) { as<std::int64_t>(name, value, first, last); }

private:
    /// Type of the numbers of an item: a class consists of doubles.
    template <class Item>
    using NumberOf = std::conditional_t<std::is_class_v<Item>, double, Item>;

    Archive(std::vector<std::byte>* to, std::span<const std::byte> from) noexcept : to_(to), from_(from) {}

    template <class Number>
    [[nodiscard]] static constexpr ArchiveType type_of() noexcept {
        if constexpr (std::is_same_v<Number, double>) return ArchiveType::real;
        if constexpr (std::is_same_v<Number, float>) return ArchiveType::single;
        if constexpr (std::is_same_v<Number, std::int64_t>) return ArchiveType::count;
        if constexpr (std::is_same_v<Number, std::uint64_t>) return ArchiveType::word;
        static_assert(sizeof(Number) == 1 || sizeof(Number) == 8 || std::is_same_v<Number, float>, "no type of archives");
        return ArchiveType::byte;
    }
    /// Stored as another type, which is checked to be within limits.
    template <class Stored, class T>
    void as(std::string_view name, T& value, std::int64_t least, std::int64_t most) {
        auto stored = static_cast<Stored>(value);
        fixed(name, std::span(&stored, 1));
        if (!reads()) return;
        if (static_cast<std::int64_t>(stored) < least || static_cast<std::int64_t>(stored) > most) refuse(name);
        value = static_cast<T>(stored);
    }
    template <class Item, std::size_t extent>
    void fixed(std::string_view name, std::span<Item, extent> values) {
        using Number = NumberOf<std::remove_const_t<Item>>;
        static_assert(std::is_trivially_copyable_v<Item> && sizeof(Item) % sizeof(Number) == 0);
        const std::size_t count = values.size_bytes() / sizeof(Number);
        if (heading(name, type_of<Number>(), sizeof(Number), count) != count) refuse(name);
        move(values.data(), values.size_bytes());
    }
    /// Writes or reads all of a field but its values. @return the count of its values, for which there are bytes
    std::size_t heading(std::string_view name, ArchiveType type, std::size_t size, std::size_t count);
    void move(void* values, std::size_t bytes) {
        if (bytes == 0) return;
        if (!reads()) {
            const auto* begin = static_cast<const std::byte*>(values);
            to_->insert(to_->end(), begin, begin + bytes);
            return;
        }
        std::memcpy(values, from_.data(), bytes);
        from_ = from_.subspan(bytes);
    }

    std::vector<std::byte>* to_;
    std::span<const std::byte> from_;
};

/// Replaces bytes by the fields that visit(archive) writes; keeps their memory.
void write_fields(std::vector<std::byte>& bytes, const auto& visit) {
    bytes.clear();
    Archive archive = Archive::to(bytes);
    visit(archive);
}
/// @throws ArchiveError if these are not the fields that visit(archive) reads, of which some are taken then
void read_fields(std::span<const std::byte> bytes, const auto& visit) {
    Archive archive = Archive::from(bytes);
    visit(archive);
    archive.end();
}

/// A whole state: "CVTSTATE", the version of the format (8 bytes), fields, the Checksum of all before.
inline constexpr std::string_view state_mark = "CVTSTATE", hdf5_mark = "\x89HDF";
inline constexpr std::uint64_t state_version = 1;
/// The state of the fields that visit(archive) writes. @param expected_size  bytes
[[nodiscard]] std::vector<std::byte> state_of(const std::function<void(Archive&)>& visit, std::size_t expected_size = 0);
/// Whether bytes begin with a mark.
[[nodiscard]] bool begins_with(std::span<const std::byte> bytes, std::string_view mark) noexcept;
/// @throws ArchiveError if bytes do not begin as a state of this version
void require_state(std::span<const std::byte> bytes);
/// Fields of a state. @throws ArchiveError: no state, of another version, damaged
[[nodiscard]] std::span<const std::byte> fields_of_state(std::span<const std::byte> state);

}  // namespace cvtflow::engine
