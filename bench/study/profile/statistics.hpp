#pragma once
/// Medians: on a machine with neighbours nothing else can be compared.

#include <algorithm>
#include <vector>

namespace cvtflow::bench {

struct Spread {
    double lower_quartile = 0.0;  ///< [unit of the samples]
    double median = 0.0;          ///< [unit of the samples]
    double upper_quartile = 0.0;  ///< [unit of the samples]
};

/// Median of an odd number of values: the middle one; of an even number: the mean of the middle two. Zero of none.
[[nodiscard]] inline double median(std::vector<double> values) {
    if (values.empty()) return 0.0;
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

/// Quartiles are the values at the nearest ranks below.
[[nodiscard]] inline Spread spread(std::vector<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const std::size_t last = values.size() - 1;
    return {values[last / 4], median(values), values[last - last / 4]};
}

}  // namespace cvtflow::bench
