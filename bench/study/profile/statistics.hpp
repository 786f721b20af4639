#pragma once
/// Medians: on a machine with neighbours nothing else can be compared.

#include <vector>

namespace cvtflow::bench {

struct Spread {
    double lower_quartile = 0.0;  ///< [unit of the samples]
    double median = 0.0;          ///< [unit of the samples]
    double upper_quartile = 0.0;  ///< [unit of the samples]
};

/// Median of an odd number of values: the middle one; of an even number: the mean of the middle two. Zero of none.
[[nodiscard]] double median(std::vector<double> values);

/// Quartiles are the values at the nearest ranks below.
[[nodiscard]] Spread spread(std::vector<double> values);

}  // namespace cvtflow::bench
