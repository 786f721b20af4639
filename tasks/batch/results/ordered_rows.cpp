#include "tasks/batch/results/ordered_rows.hpp"

#include <algorithm>

#include "tasks/batch/results/results.hpp"

namespace cvtflow::tasks {

namespace {

constexpr std::size_t window_rows = 256;  ///< rows lie nearly in the order of their cases

}  // namespace

OrderedRows::OrderedRows(const std::string& path) : reader_(path) {
    const engine::RowLayout& layout = head().layout;
    const std::size_t number = layout.column("case");
    order_.reserve(reader_.size());
    for (std::size_t i = 0; i < reader_.size(); ++i) {
        order_.emplace_back(0, i);
        const auto at = row(i);
        order_.back().first = layout.integer(at, number);
        tally_.add(layout, at);
    }
    std::sort(order_.begin(), order_.end());
}

/// A row of the file.
std::span<const std::byte> OrderedRows::row(std::size_t place) {
    const std::size_t bytes = head().layout.bytes();
    if (place < first_ || place >= first_ + window_.size() / bytes) {
        first_ = place / window_rows * window_rows;
        window_.resize(std::min(window_rows, reader_.size() - first_) * bytes);
        reader_.read(first_, window_);
    }
    return std::span<const std::byte>(window_).subspan((place - first_) * bytes, bytes);
}

std::span<const std::byte> OrderedRows::of_case(long number) {
    const auto found = std::lower_bound(order_.begin(), order_.end(), std::pair<long, std::size_t>(number, 0));
    return found == order_.end() || found->first != number ? std::span<const std::byte>() : row(found->second);
}

std::string OrderedRows::hash() {
    engine::Hash hash;
    for (const auto& [number, place] : order_) add_result(hash, head().layout, row(place));
    return hash.hex();
}

void OrderedRows::fill(std::size_t first, std::span<std::byte> rows) {
    const std::size_t bytes = head().layout.bytes();
    for (std::size_t i = 0; i < rows.size() / bytes; ++i)
        std::ranges::copy(row(order_[first + i].second), rows.begin() + static_cast<std::ptrdiff_t>(i * bytes));
}

}  // namespace cvtflow::tasks
