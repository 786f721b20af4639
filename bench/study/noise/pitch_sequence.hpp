#pragma once
/// Sequences of pitches that keep the chain's length, and a search among them by a closed form.

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "bench/study/noise/tonality.hpp"

namespace cvtflow::bench {

/// -1, 0 or 1 per link: shorter than the mean pitch, equal to it, longer. As many -1 as 1.
using PitchSequence = std::vector<int>;

/// @param spread by which pitches differ from their mean [share of it]   @return [links] [m]
[[nodiscard]] std::vector<double> pitches_of(const PitchSequence& sequence, double mean, double spread);

/// |sum over pins of exp(2 pi i n s/L)|²/N² for orders n = 0 … last: powers of equal impulses at the pins' places s, relative to those of a
/// uniform chain at multiples of N.
[[nodiscard]] OrderPowers impulse_powers(const PitchSequence& sequence, double spread, int last);

/// Searches sequences whose impulses, weighted by what equal impulses excite in the machine, have little tonality.
class PitchSearch {
public:
    /// @param lengths 2 or 3   @param round frequency of order 1 [Hz]
    /// @throws std::invalid_argument for two lengths and an odd number of pins
    PitchSearch(int pins, int lengths, double spread, double round);

    /// Takes from simulated sequences what impulses of each order excite: their mean powers over the mean powers of their impulses.
    /// @param powers one signal's, of each sequence
    void weigh(const std::vector<PitchSequence>& sequences, const std::vector<OrderPowers>& powers);

    /// The sequence shuffled. A seed gives the same order everywhere.
    [[nodiscard]] PitchSequence random(std::mt19937_64& random) const;
    /// The largest tonality of the signals that the closed form expects [dB].
    [[nodiscard]] double expected(const PitchSequence& sequence) const;
    /// From a shuffled sequence: exchanges two links as long as `expected` does not grow. @param moves exchanges to try
    [[nodiscard]] PitchSequence climb(std::mt19937_64& random, int moves) const;

private:
    PitchSequence sorted_;
    double spread_, round_;
    std::vector<OrderPowers> weights_;  ///< [signals][orders]
};

}  // namespace cvtflow::bench
