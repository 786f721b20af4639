#pragma once
/// What a warm start from a neighbouring case changes in the results: some cases, the last of their strands, run once more from the start
/// that they would have had without it.

#include <string>

#include "tasks/batch/case_engine.hpp"
#include "tasks/batch/results/ordered_rows.hpp"

namespace cvtflow::tasks {

/// Cases to run once more: the last of so many strands, spread evenly over those of a shard, whose row is ok. Ascending.
[[nodiscard]] std::vector<long> cases_to_check(const Sweep& sweep, const std::vector<long>& cases, OrderedRows& rows);

/// Largest difference of each scalar between continued and own start.
class ContinuationError {
public:
    explicit ContinuationError(const Sweep& sweep) : sweep_(sweep), largest_(sweep.scalars.size()), size_(largest_) {}

    /// @param again the case from its own start, with the status ok
    void add(OrderedRows& rows, const CaseResult& again);
    /// "2 cases, at most: slip mean 1.2e-04 (0.8 %), ratio final 3e-07 (3e-05 %)", percentages of the value from the own start; empty
    /// without cases
    [[nodiscard]] std::string text() const;

private:
    const Sweep& sweep_;
    int cases_ = 0;
    std::vector<double> largest_, size_;  ///< [scalars of the sweep]
};

}  // namespace cvtflow::tasks
