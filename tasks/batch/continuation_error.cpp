#include "tasks/batch/continuation_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace cvtflow::tasks {

namespace {

std::optional<std::size_t> row_of(const engine::CaseTable& table, long number) {
    const std::size_t column = table.layout.column("case");
    for (std::size_t row = 0; row < table.size(); ++row) {
        if (table.layout.integer(table.row(row), column) == number) return row;
    }
    return {};
}

}  // namespace

std::vector<long> cases_to_check(const Sweep& sweep, const std::vector<long>& cases, const engine::CaseTable& table) {
    const std::size_t strand = static_cast<std::size_t>(sweep.strand());
    const std::size_t strands = cases.size() / strand;
    const std::size_t wanted = strand > 1 ? std::min(strands, static_cast<std::size_t>(sweep.checked)) : 0;
    std::vector<long> chosen;
    for (std::size_t k = 0; k < wanted; ++k) {
        const long number = cases[((2 * k + 1) * strands / (2 * wanted)) * strand + strand - 1];
        const auto row = row_of(table, number);
        if (row && table.layout.text(table.row(*row), table.layout.column("status")) == status_name(CaseStatus::ok)) chosen.push_back(number);
    }
    return chosen;
}

void ContinuationError::add(const engine::CaseTable& table, const CaseResult& again) {
    const auto row = row_of(table, again.number);
    if (!row) return;
    ++cases_;
    for (std::size_t i = 0; i < largest_.size(); ++i) {
        const double difference = std::abs(table.layout.real(table.row(*row), table.layout.column(sweep_.scalars[i].column)) - again.scalars[i]);
        if (difference < largest_[i] || (difference == 0.0 && cases_ > 1)) continue;
        largest_[i] = difference;
        size_[i] = std::abs(again.scalars[i]);
    }
}

std::string ContinuationError::text() const {
    std::vector<std::string> parts;
    for (std::size_t i = 0; i < largest_.size(); ++i) {
        const std::string share = size_[i] > 0.0 ? fmt::format(" ({:.2g} %)", 100.0 * largest_[i] / size_[i]) : "";
        parts.push_back(fmt::format("{} {:.2g}{}", sweep_.scalars[i].text, largest_[i], share));
    }
    return cases_ == 0 ? "" : fmt::format("{} {}, at most: {}", cases_, cases_ == 1 ? "case" : "cases", fmt::join(parts, ", "));
}

}  // namespace cvtflow::tasks
