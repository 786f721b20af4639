#pragma once
/// The rows of a table on disk in the order of their cases, a few at a time: memory grows by 16 bytes per case and no more.

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/record/case_table.hpp"
#include "tasks/batch/results/tally.hpp"

namespace cvtflow::tasks {

class OrderedRows {
public:
    /// @throws engine::RecordError
    explicit OrderedRows(const std::string& path);

    [[nodiscard]] const engine::CaseTable& head() const noexcept { return reader_.head(); }
    [[nodiscard]] std::size_t size() const noexcept { return order_.size(); }
    [[nodiscard]] const CaseTally& tally() const noexcept { return tally_; }
    /// Row of a case, valid until the next call; empty if it has none.
    [[nodiscard]] std::span<const std::byte> of_case(long number);
    /// results_hash() of all rows.
    [[nodiscard]] std::string hash();
    /// For engine::write_cases().
    void fill(std::size_t first, std::span<std::byte> rows);

private:
    [[nodiscard]] std::span<const std::byte> row(std::size_t place);

    engine::CaseReader reader_;
    std::vector<std::pair<long, std::size_t>> order_;  ///< case, row in the file; ascending
    CaseTally tally_;
    std::vector<std::byte> window_;  ///< rows from first_ on
    std::size_t first_ = 0;
};

}  // namespace cvtflow::tasks
