#pragma once
/// Differences between two records over their common time.

#include <string>
#include <vector>

#include "tools/program/view/recorded_run.hpp"

namespace cvtflow::tools {

/// A mean of both, and their difference.
struct MeanDifference {
    double a = 0.0, b = 0.0;  ///< in the unit of the channel
    [[nodiscard]] double absolute() const noexcept { return b - a; }
    /// Of the magnitude of a; not a number where a is 0 [1].
    [[nodiscard]] double relative() const noexcept;
};

/// A channel of the overview that both records have.
struct ChannelDifference {
    Curve curve;                ///< its values: B - A
    MeanDifference all, last;   ///< over all common rows, over the last fifth of them
    double largest = 0.0;       ///< largest |B - A|, in the unit of the channel
    double largest_time = 0.0;  ///< when [s]
};

struct RunDifference {
    std::vector<double> times;                ///< rows of A within the time that both have [s]
    std::vector<ChannelDifference> channels;  ///< in the order of A; B is interpolated linearly to the times of A
    std::vector<std::string> only_a, only_b;  ///< channels of the overview of one alone
};

/// Without a common row there are no channels.
[[nodiscard]] RunDifference difference(const RecordedRun& a, const RecordedRun& b);

/// A key whose values differ.
struct KeyDifference {
    std::string key, a, b, meaning;
};

/// Keys of the scenes that differ, as TOML; the scene's own name and description are no difference.
[[nodiscard]] std::vector<KeyDifference> differing_keys(const tasks::Scene& a, const tasks::Scene& b);

}  // namespace cvtflow::tools
