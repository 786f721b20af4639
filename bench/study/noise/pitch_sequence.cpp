#include "bench/study/noise/pitch_sequence.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

namespace cvtflow::bench {
namespace {

/// 0 … count - 1, the same with every standard library.
std::size_t drawn(std::mt19937_64& random, std::size_t count) {
    return static_cast<std::size_t>(static_cast<double>(random() >> 11) * 0x1p-53 * static_cast<double>(count));
}

}  // namespace

std::vector<double> pitches_of(const PitchSequence& sequence, double mean, double spread) {
    std::vector<double> pitches;
    for (const int step : sequence) pitches.push_back(mean * (1.0 + spread * step));
    return pitches;
}

OrderPowers impulse_powers(const PitchSequence& sequence, double spread, int last) {
    const auto pins = static_cast<double>(sequence.size());
    std::vector<std::complex<double>> sums(static_cast<std::size_t>(last) + 1);
    double place = 0.0;
    for (const int step : sequence) {
        const std::complex<double> turn = std::polar(1.0, 2.0 * std::numbers::pi * place / pins);
        std::complex<double> phase = 1.0;
        for (std::complex<double>& sum : sums) {
            sum += phase;
            phase = {phase.real() * turn.real() - phase.imag() * turn.imag(), phase.real() * turn.imag() + phase.imag() * turn.real()};
        }
        place += 1.0 + spread * step;
    }
    OrderPowers powers;
    for (const std::complex<double>& sum : sums) powers.push_back(std::norm(sum) / (pins * pins));
    return powers;
}

PitchSearch::PitchSearch(int pins, int lengths, double spread, double round)
    : sorted_(static_cast<std::size_t>(pins), 0), spread_(spread), round_(round) {
    if (lengths == 2 && pins % 2 != 0)
        throw std::invalid_argument("two lengths with the mean of the uniform chain need an even number of pins; take three");
    const int each = pins / lengths;
    std::fill_n(sorted_.begin(), each, -1);
    std::fill_n(sorted_.rbegin(), each, 1);
}

void PitchSearch::weigh(const std::vector<PitchSequence>& sequences, const std::vector<OrderPowers>& powers) {
    OrderPowers response(powers.front().size()), impulses(response);
    for (std::size_t k = 0; k < sequences.size(); ++k) {
        const OrderPowers own = impulse_powers(sequences[k], spread_, static_cast<int>(response.size()) - 1);
        for (std::size_t n = 0; n < response.size(); ++n) {
            response[n] += powers[k][n];
            impulses[n] += own[n];
        }
    }
    for (std::size_t n = 0; n < response.size(); ++n) response[n] /= impulses[n];
    weights_.push_back(std::move(response));
}

PitchSequence PitchSearch::random(std::mt19937_64& random) const {
    PitchSequence sequence = sorted_;
    for (std::size_t k = sequence.size() - 1; k > 0; --k) std::swap(sequence[k], sequence[drawn(random, k + 1)]);
    return sequence;
}

double PitchSearch::expected(const PitchSequence& sequence) const {
    const OrderPowers impulses = impulse_powers(sequence, spread_, static_cast<int>(weights_.front().size()) - 1);
    double largest = 0.0;
    for (const OrderPowers& weights : weights_) {
        OrderPowers powers(weights);
        for (std::size_t order = 0; order < powers.size(); ++order) powers[order] *= impulses[order];
        largest = std::max(largest, tonality(powers, round_, static_cast<int>(sequence.size())));
    }
    return largest;
}

PitchSequence PitchSearch::climb(std::mt19937_64& random, int moves) const {
    PitchSequence best = this->random(random);
    double lowest = expected(best);
    for (int move = 0; move < moves; ++move) {
        PitchSequence changed = best;
        std::swap(changed[drawn(random, changed.size())], changed[drawn(random, changed.size())]);
        if (changed == best) continue;
        const double now = expected(changed);
        if (now > lowest) continue;
        best = std::move(changed);
        lowest = now;
    }
    return best;
}

}  // namespace cvtflow::bench
