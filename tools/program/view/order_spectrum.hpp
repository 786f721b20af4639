#pragma once
/// Amplitudes over frequency.

#include <vector>

namespace cvtflow::tools {

struct AmplitudeSpectrum {
    std::vector<double> frequency;  ///< [Hz], from 0 to half of the sampling rate
    std::vector<double> amplitude;  ///< a sine of amplitude a at a frequency of the grid has a peak of a
};

/// Spectrum of equidistant values: mean removed, Hann window, padded with zeros to a power of two of at least twice the length.
/// Empty for fewer than 8 values. A trailing value at another distance (a run that ended between outputs) is left out.
[[nodiscard]] AmplitudeSpectrum amplitude_spectrum(const std::vector<double>& times, std::vector<double> values);

}  // namespace cvtflow::tools
