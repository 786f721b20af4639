#pragma once
/// How tonal a spectrum by orders is, as a listener's ear groups it.

#include <vector>

namespace cvtflow::bench {

/// Mean square of a quantity at orders 0, 1, … of the chain's revolution; order `pins` is the passing of pins.
using OrderPowers = std::vector<double>;

/// Power that bands contain at least, relative to the strongest: a background that bounds prominence ratios to 60 dB.
inline constexpr double background = 1e-6;

/// Width of the ear's critical band around a frequency: 25 + 75 (1 + 1.4 (f/kHz)²)^0.69. [Hz] (Zwicker and Terhardt 1980; ECMA-418-1)
[[nodiscard]] double critical_bandwidth(double frequency);

/// Largest prominence ratio of a critical band over its two neighbours [dB], after ECMA-418-1, section 12. Bands are centred at every order
/// from half of the pin passing to 3.5 times of it, except those 20 dB weaker than the strongest. Simplified: neighbours have the critical
/// bandwidth of their own middles instead of the standard's fitted edges, lines are spread over one order, and the hearing threshold is
/// left out.
/// @param powers up to order 5 pins at least   @param round frequency of order 1 [Hz]
[[nodiscard]] double tonality(const OrderPowers& powers, double round, int pins);

/// Rank correlation of Spearman; zero for fewer than 3 pairs.
[[nodiscard]] double rank_correlation(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace cvtflow::bench
