#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "engine/base/hash.hpp"
#include "engine/record/table/case_table.hpp"

namespace cvtflow::engine {

RowLayout::RowLayout(std::vector<CaseColumn> columns) : columns_(std::move(columns)) {
    for (const CaseColumn& column : columns_) {
        offsets_.push_back(bytes_);
        bytes_ += static_cast<std::size_t>(column.width);
    }
    bytes_ += sizeof(std::uint64_t);  // check
}

bool RowLayout::has(std::string_view name) const noexcept {
    return std::any_of(columns_.begin(), columns_.end(), [&](const CaseColumn& each) { return each.name == name; });
}

std::size_t RowLayout::column(std::string_view name) const {
    const auto found = std::find_if(columns_.begin(), columns_.end(), [&](const CaseColumn& each) { return each.name == name; });
    if (found == columns_.end()) throw std::out_of_range("no column " + std::string(name));
    return static_cast<std::size_t>(found - columns_.begin());
}

void RowLayout::put(std::span<std::byte> row, std::size_t column, double value) const noexcept {
    std::memcpy(row.data() + offsets_[column], &value, sizeof value);
}
void RowLayout::put(std::span<std::byte> row, std::size_t column, std::int64_t value) const noexcept {
    std::memcpy(row.data() + offsets_[column], &value, sizeof value);
}

void RowLayout::put(std::span<std::byte> row, std::size_t column, std::string_view text) const noexcept {
    const std::size_t width = static_cast<std::size_t>(columns_[column].width);
    std::byte* begin = row.data() + offsets_[column];
    std::memset(begin, 0, width);
    text.copy(reinterpret_cast<char*>(begin), width);
}

double RowLayout::real(std::span<const std::byte> row, std::size_t column) const noexcept {
    double value = 0.0;
    std::memcpy(&value, row.data() + offsets_[column], sizeof value);
    return value;
}

std::int64_t RowLayout::integer(std::span<const std::byte> row, std::size_t column) const noexcept {
    std::int64_t value = 0;
    std::memcpy(&value, row.data() + offsets_[column], sizeof value);
    return value;
}

std::string RowLayout::text(std::span<const std::byte> row, std::size_t column) const {
    const char* begin = reinterpret_cast<const char*>(row.data() + offsets_[column]);
    return {begin, strnlen(begin, static_cast<std::size_t>(columns_[column].width))};
}

std::string RowLayout::cell(std::span<const std::byte> row, std::size_t column) const {
    switch (columns_[column].type) {
        case CaseColumnType::real: return fmt::format("{}", real(row, column));
        case CaseColumnType::integer: return std::to_string(integer(row, column));
        case CaseColumnType::text: return text(row, column);
    }
    return {};
}

std::uint64_t RowLayout::check(std::span<const std::byte> row) const noexcept {
    return Hash().add(row.first(bytes_ - sizeof(std::uint64_t))).value();
}

void RowLayout::seal(std::span<std::byte> row) const noexcept {
    const std::uint64_t value = check(row);
    std::memcpy(row.data() + bytes_ - sizeof value, &value, sizeof value);
}

bool RowLayout::sound(std::span<const std::byte> row) const noexcept {
    const std::uint64_t value = check(row);
    return std::memcmp(row.data() + bytes_ - sizeof value, &value, sizeof value) == 0;
}

std::string CaseTable::attribute(std::string_view name) const {
    for (const Attribute& each : attributes) {
        if (each.name != name) continue;
        if (const auto* text = std::get_if<std::string>(&each.value)) return *text;
        if (const auto* integer = std::get_if<std::int64_t>(&each.value)) return std::to_string(*integer);
        return fmt::format("{}", std::get<double>(each.value));
    }
    return {};
}

void CaseTable::set(Attribute attribute) {
    std::erase_if(attributes, [&](const Attribute& each) { return each.name == attribute.name; });
    attributes.push_back(std::move(attribute));
}

}  // namespace cvtflow::engine
