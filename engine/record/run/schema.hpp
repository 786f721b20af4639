#pragma once
/// Contents of a record of any simulation: channels, tables, attributes; and the settings of HDF5 for a program.

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/base/provenance.hpp"

namespace cvtflow::engine {

/// Every failure of engine/record. what() is "path: what was tried: reason", ready for a user.
struct RecordError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A quantity recorded over time.
struct ChannelInfo {
    std::string name{};         ///< e.g. "strand_tension", or in groups: "links/tension"
    std::string unit{};         ///< e.g. "N"; "1" for a pure number
    std::string description{};  ///< one sentence
    int width = 1;              ///< numbers per instant; > 1 makes a dataset [time, width]
    std::string axis{};         ///< label of the second dimension, e.g. "link"; only used if width > 1
    bool operator==(const ChannelInfo&) const = default;
};

enum class ColumnType { real, integer };

struct TableColumn {
    std::string name{};
    std::string unit{};
    std::string description{};
    ColumnType type = ColumnType::real;
    bool operator==(const TableColumn&) const = default;
};

/// Records that come at irregular times, e.g. events: one row of named columns each.
struct TableInfo {
    std::string name{};
    std::string description{};
    std::vector<TableColumn> columns{};
    bool operator==(const TableInfo&) const = default;
};

struct Attribute {
    std::string name;
    std::variant<std::string, double, std::int64_t> value;
    bool operator==(const Attribute&) const = default;
};

/// Value of the attribute of that name, if there is one of that type; else nullptr.
template <class Value>
[[nodiscard]] const Value* attribute_value(const std::vector<Attribute>& attributes, std::string_view name) noexcept {
    for (const Attribute& each : attributes)
        if (each.name == name) return std::get_if<Value>(&each.value);
    return nullptr;
}

/// Provenance as attributes "program_version", "commit", "compiler", "build_type", "instruction_set", "cpu", "cores", "os", "date",
/// and "hdf5_version".
[[nodiscard]] std::vector<Attribute> attributes_of(const Provenance& provenance);

/// Disables HDF5's exit handler, which crashes if a file could not be closed (disk full), or may not end after a damaged file ("HDF5:
/// infinite loop closing library"). Files are closed before, where errors are reported. Call it before anything else of this folder, from
/// programs only: a library's host may have files that HDF5 has to close.
void disable_hdf5_atexit() noexcept;

}  // namespace cvtflow::engine
