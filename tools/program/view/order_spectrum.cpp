#include "tools/program/view/order_spectrum.hpp"

#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

namespace cvtflow::tools {

namespace {

using Number = std::complex<double>;

/// In place; the length is a power of two.
void transform(std::vector<Number>& values) {
    const std::size_t n = values.size();
    for (std::size_t i = 1, j = 0; i < n; ++i) {
        std::size_t bit = n >> 1U;
        for (; (j & bit) != 0; bit >>= 1U) j ^= bit;
        j ^= bit;
        if (i < j) std::swap(values[i], values[j]);
    }
    std::vector<Number> turn(n / 2);
    for (std::size_t k = 0; k < turn.size(); ++k)
        turn[k] = std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n));
    for (std::size_t length = 2; length <= n; length *= 2) {
        const std::size_t half = length / 2, stride = n / length;
        for (std::size_t begin = 0; begin < n; begin += length) {
            for (std::size_t k = 0; k < half; ++k) {
                const Number even = values[begin + k], odd = values[begin + k + half] * turn[k * stride];
                values[begin + k] = even + odd;
                values[begin + k + half] = even - odd;
            }
        }
    }
}

}  // namespace

AmplitudeSpectrum amplitude_spectrum(const std::vector<double>& times, std::vector<double> values) {
    AmplitudeSpectrum spectrum;
    if (times.size() != values.size() || values.size() < 8) return spectrum;
    const double distance = times[1] - times[0];
    if (!(distance > 0.0)) return spectrum;
    if (std::abs(times.back() - times[times.size() - 2] - distance) > 1e-3 * distance) values.pop_back();
    const auto count = static_cast<double>(values.size());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
    std::vector<Number> padded(2 * std::bit_ceil(values.size()));
    double weights = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        const double window = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(k) / count);
        padded[k] = window * (values[k] - mean);
        weights += window;
    }
    transform(padded);
    for (std::size_t k = 0; k <= padded.size() / 2; ++k) {
        spectrum.frequency.push_back(static_cast<double>(k) / (static_cast<double>(padded.size()) * distance));
        spectrum.amplitude.push_back(2.0 * std::abs(padded[k]) / weights);
    }
    return spectrum;
}

}  // namespace cvtflow::tools
