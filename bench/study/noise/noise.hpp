#pragma once
/// Noise of a chain: forces on the housing and torque of the shafts by orders of the chain's revolution, of a simulation; tonality of such
/// a spectrum for a listener; and sequences of pitches that keep the chain's length, with a search among them by a closed form.

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "engine/executor/cancellation.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::bench {

/// Mean square of a quantity at orders 0, 1, … of the chain's revolution; order `pins` is the passing of pins.
using OrderPowers = std::vector<double>;

/// Power that bands contain at least, relative to the strongest: a background that bounds prominence ratios to 60 dB.
inline constexpr double background = 1e-6;

/// Width of the ear's critical band around a frequency: 25 + 75 (1 + 1.4 (f/kHz)²)^0.69. [Hz] (Zwicker and Terhardt 1980; ECMA-418-1)
[[nodiscard]] double critical_bandwidth(double frequency);

/// Largest prominence ratio of a critical band over its two neighbours [dB], after ECMA-418-1, section 12. Bands are centred at every order
/// from half of the pin passing to 3.5 times of it, except those 20 dB weaker than the strongest. Simplified: neighbours have the critical
/// bandwidth of their middles instead of the standard's fitted edges, lines are spread over one order, and the hearing threshold is left
/// out.
/// @param powers up to order 5 pins at least   @param round frequency of order 1 [Hz]
[[nodiscard]] double tonality(const OrderPowers& powers, double round, int pins);

/// Rank correlation of Spearman; zero for fewer than 3 pairs.
[[nodiscard]] double rank_correlation(const std::vector<double>& a, const std::vector<double>& b);

/// -1, 0 or 1 per link: shorter than the mean pitch, equal to it, longer. As many -1 as 1.
using PitchSequence = std::vector<int>;

/// @param spread difference of pitches from their mean [share of the mean]   @return [links] [m]
[[nodiscard]] std::vector<double> pitches_of(const PitchSequence& sequence, double mean, double spread);

/// |sum over pins of exp(2 pi i n s/L)|²/N² for orders n = 0 … last: powers of equal impulses at the pins' places s, relative to those of a
/// uniform chain at multiples of N.
[[nodiscard]] OrderPowers impulse_powers(const PitchSequence& sequence, double spread, int last);

/// Searches sequences whose impulses, weighted by the machine's response to equal impulses, have little tonality.
class PitchSearch {
public:
    /// @param lengths 2 or 3   @param round frequency of order 1 [Hz]
    /// @throws std::invalid_argument for two lengths and an odd number of pins
    PitchSearch(int pins, int lengths, double spread, double round);

    /// Takes the response to impulses of each order from simulated sequences: their mean powers over the mean powers of their impulses.
    /// @param powers one signal's, of each sequence
    void weigh(const std::vector<PitchSequence>& sequences, const std::vector<OrderPowers>& powers);

    /// Shuffled sequence. A seed gives the same order everywhere.
    [[nodiscard]] PitchSequence random(std::mt19937_64& random) const;
    /// Largest tonality of the signals that the closed form expects [dB].
    [[nodiscard]] double expected(const PitchSequence& sequence) const;
    /// Climbs from a shuffled sequence: exchanges two links as long as `expected` does not grow. @param moves exchanges to try
    [[nodiscard]] PitchSequence climb(std::mt19937_64& random, int moves) const;

private:
    PitchSequence sorted_;
    double spread_, round_;
    std::vector<OrderPowers> weights_;  ///< [signals][orders]
};

inline constexpr int noise_harmonics = 5;  ///< harmonics of the pin passing that spectra reach

struct NoiseSpectrum {
    std::string fault;         ///< reason for a missing spectrum of a simulation; empty: there is one
    double round = 0.0;        ///< turns of the chain per second [Hz]
    OrderPowers force;         ///< radial forces of both shafts on their bearings, sum of the squares [N²]
    OrderPowers torque;        ///< torques of the chain on both shafts, sum of the squares [N² m²]
    double force_tone = 0.0;   ///< tonality() of the forces [dB]
    double torque_tone = 0.0;  ///< tonality() of the torques [dB]
    double wall = 0.0;         ///< [s]

    [[nodiscard]] bool simulated() const noexcept { return wall > 0.0; }
    [[nodiscard]] bool usable() const noexcept { return simulated() && fault.empty(); }
    /// The larger of both [dB].
    [[nodiscard]] double tone() const noexcept { return force_tone > torque_tone ? force_tone : torque_tone; }
};

/// Settles the scene's chain if its start is geometric, then takes `rounds` whole revolutions of its first pin.
[[nodiscard]] NoiseSpectrum measure_noise(tasks::Scene scene, int rounds, const engine::Cancellation& cancel);

}  // namespace cvtflow::bench
