#pragma once
/// Curves and the chain's motion as data for the scripts of a page.

#include <nlohmann/json.hpp>
#include <vector>

#include "tools/program/view/chain_motion.hpp"
#include "tools/program/view/recorded_run.hpp"

namespace cvtflow::tools {

/// Rows in groups; of each group the minimum and the maximum are kept, in their order.
struct Stretches {
    std::size_t rows, count;  ///< count: 0: every row is kept

    [[nodiscard]] std::size_t begin(std::size_t number) const noexcept { return number * rows / count; }
    /// Times that values() belong to.
    [[nodiscard]] std::vector<double> times(const std::vector<double>& all) const;
    [[nodiscard]] std::vector<float> values(const std::vector<double>& all) const;
};

/// All curves of a record, in at most about `max_bytes` bytes of text. {"label", "rows", "shown", "t", "curves": [{"n", "u", "d", "v" or
/// "c"}]}
[[nodiscard]] nlohmann::json curve_data(const RecordedRun& run, std::size_t max_bytes);

[[nodiscard]] nlohmann::json motion_data(const ChainMotion& motion);

}  // namespace cvtflow::tools
