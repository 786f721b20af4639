#pragma once
/// Sequences of pitches with their spectra: as text, CSV, JSON and picture.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/study/noise/measured_noise.hpp"
#include "bench/study/noise/pitch_sequence.hpp"
#include "tools/program/plot/plot.hpp"

namespace cvtflow::bench {

struct NoiseRow {
    std::string name;            ///< "uniform", "random 3", "searched 12"
    bool random = false;         ///< shuffled, not searched
    PitchSequence sequence;      ///< [links]
    double expected = 0.0;       ///< tonality by the closed form [dB]
    NoiseSpectrum rigid, check;  ///< at the level `rigid`, at the level of the check
};

struct NoiseResult {
    std::string scene, level;  ///< of the check
    double mean = 0.0;         ///< pitch [m]
    double spread = 0.0;       ///< [1]
    std::uint64_t seed = 0;
    std::vector<NoiseRow> rows;  ///< uniform, random ones, searched ones
    std::size_t best = 0;        ///< row with the least tonality in the check
    double wall = 0.0;           ///< [s]

    [[nodiscard]] int pins() const { return static_cast<int>(rows.front().sequence.size()); }
};

/// "[0.0074704,0.0087696,…]", as chain.pitch takes it [m].
[[nodiscard]] std::string pitch_text(const NoiseRow& row, const NoiseResult& result);
[[nodiscard]] std::string noise_text(const NoiseResult& result);
[[nodiscard]] std::string noise_csv(const NoiseResult& result);
[[nodiscard]] nlohmann::ordered_json noise_json(const NoiseResult& result);
/// Spectra of the uniform chain and of the best one, as checked.
[[nodiscard]] std::vector<tools::Plot> noise_plots(const NoiseResult& result);

}  // namespace cvtflow::bench
