#include "tasks/batch/continuation_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cvtflow::tasks {

std::vector<long> cases_to_check(const Sweep& sweep, const std::vector<long>& cases, OrderedRows& rows) {
    const std::size_t strand = static_cast<std::size_t>(sweep.strand());
    const std::size_t strands = cases.size() / strand;
    const std::size_t requested = strand > 1 ? std::min(strands, static_cast<std::size_t>(sweep.checked)) : 0;
    std::vector<long> chosen;
    for (std::size_t k = 0; k < requested; ++k) {
        const long number = cases[((2 * k + 1) * strands / (2 * requested)) * strand + strand - 1];
        const engine::RowLayout& layout = rows.head().layout;
        const auto row = rows.of_case(number);
        if (!row.empty() && layout.text(row, layout.column("status")) == status_name(CaseStatus::ok)) chosen.push_back(number);
    }
    return chosen;
}

void ContinuationError::add(OrderedRows& rows, const CaseResult& again) {
    const engine::RowLayout& layout = rows.head().layout;
    const auto row = rows.of_case(again.number);
    if (row.empty()) return;
    ++cases_;
    for (std::size_t i = 0; i < largest_.size(); ++i) {
        const double difference = std::abs(layout.real(row, layout.column(sweep_.scalars[i].column)) - again.scalars[i]);
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
