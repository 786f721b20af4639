#pragma once
/// What the rows of a sweep amount to: statuses, reasons of failures, notes.

#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/record/case_table.hpp"

namespace cvtflow::tasks {

class CaseTally {
public:
    /// A message with which cases failed.
    struct Failure {
        std::string status, error;
        long first = 0;  ///< smallest number of its cases
        long cases = 0;
    };
    static constexpr std::size_t max_failures = 3;

    void add(const engine::RowLayout& layout, std::span<const std::byte> row);

    [[nodiscard]] long rows() const noexcept { return rows_; }
    /// Rows with another status than ok.
    [[nodiscard]] long failed() const noexcept;
    [[nodiscard]] const std::map<std::string, long>& statuses() const noexcept { return statuses_; }
    [[nodiscard]] const std::map<std::string, long>& notes() const noexcept { return notes_; }
    /// The first few different messages, in the order of the rows.
    [[nodiscard]] const std::vector<Failure>& failures() const noexcept { return failures_; }

private:
    long rows_ = 0;
    std::map<std::string, long> statuses_, notes_;
    std::vector<Failure> failures_;
};

}  // namespace cvtflow::tasks
