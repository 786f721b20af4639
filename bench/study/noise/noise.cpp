#include "bench/study/noise/noise.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "tasks/channel/channels.hpp"
#include "tasks/run/simulation.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

/// Power between two orders, lines spread over one order each.
class BandPowers {
public:
    explicit BandPowers(const OrderPowers& powers) : sums_(powers.size() + 1) {
        std::partial_sum(powers.begin(), powers.end(), sums_.begin() + 1);
    }
    [[nodiscard]] double between(double from, double to) const { return up_to(to) - up_to(from); }

private:
    [[nodiscard]] double up_to(double order) const {
        const double place = std::clamp(order + 0.5, 0.0, static_cast<double>(sums_.size() - 1));
        const auto cell = std::min(static_cast<std::size_t>(place), sums_.size() - 2);
        return sums_[cell] + (place - static_cast<double>(cell)) * (sums_[cell + 1] - sums_[cell]);
    }
    std::vector<double> sums_;
};

/// The other edge of a critical band that ends at `edge` [Hz]. @param side -1 below, 1 above
double other_edge(double edge, double side) {
    double width = critical_bandwidth(edge);
    for (int pass = 0; pass < 6; ++pass) width = critical_bandwidth(std::sqrt(edge * std::max(0.0, edge + side * width)));
    return std::max(0.0, edge + side * width);
}

struct Prominence {
    double middle, neighbours;  ///< power of the band, mean power of its neighbours
};

Prominence prominence(const BandPowers& bands, double frequency, double round) {
    const double width = critical_bandwidth(frequency);
    const double lower = -0.5 * width + std::sqrt(0.25 * width * width + frequency * frequency), upper = lower + width;
    return {bands.between(lower / round, upper / round), 0.5 * (bands.between(other_edge(lower, -1.0) / round, lower / round) +
                                                                bands.between(upper / round, other_edge(upper, 1.0) / round))};
}

std::vector<double> ranks(const std::vector<double>& values) {
    std::vector<double> ranks;
    for (const double value : values) {
        const auto below = std::count_if(values.begin(), values.end(), [=](double v) { return v < value; });
        const auto equal = std::count(values.begin(), values.end(), value);
        ranks.push_back(static_cast<double>(below) + 0.5 * static_cast<double>(equal - 1));
    }
    return ranks;
}

}  // namespace

double critical_bandwidth(double frequency) {
    const double kilohertz = 1e-3 * frequency;
    return 25.0 + 75.0 * std::pow(1.0 + 1.4 * kilohertz * kilohertz, 0.69);
}

double tonality(const OrderPowers& powers, double round, int pins) {
    const BandPowers bands(powers);
    std::vector<Prominence> all;
    double strongest = 0.0;
    for (int order = (pins + 1) / 2; order <= 7 * pins / 2; ++order) {
        all.push_back(prominence(bands, order * round, round));
        strongest = std::max(strongest, all.back().middle);
    }
    if (!(strongest > 0.0)) return 0.0;
    double largest = 0.0;
    for (const Prominence& each : all) {
        if (each.middle < 0.01 * strongest) continue;
        largest = std::max(largest, each.middle / std::max(each.neighbours, background * strongest));
    }
    return 10.0 * std::log10(largest);
}

double rank_correlation(const std::vector<double>& a, const std::vector<double>& b) {
    if (a.size() != b.size() || a.size() < 3) return 0.0;
    const std::vector<double> x = ranks(a), y = ranks(b);
    const double mean = 0.5 * static_cast<double>(a.size() - 1);
    double xx = 0.0, yy = 0.0, xy = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        xx += (x[k] - mean) * (x[k] - mean);
        yy += (y[k] - mean) * (y[k] - mean);
        xy += (x[k] - mean) * (y[k] - mean);
    }
    return xx > 0.0 && yy > 0.0 ? xy / std::sqrt(xx * yy) : 0.0;
}

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
        const OrderPowers of_sequence = impulse_powers(sequences[k], spread_, static_cast<int>(response.size()) - 1);
        for (std::size_t n = 0; n < response.size(); ++n) {
            response[n] += powers[k][n];
            impulses[n] += of_sequence[n];
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

namespace {

constexpr std::size_t signals = 6;  ///< bearing forces x, y of both shafts, torques of the chain on both

/// Keeps the signals until the first pin has run `rounds` times about the middle of the chain.
class RoundRecorder final : public RunObserver {
public:
    RoundRecorder(const model::Variator& variator, int rounds) : variator_(variator), observer_(variator), rounds_(rounds) {}

    void output(double time, const Workspace& w, const Counters& counters) override {
        if (complete) return;
        const model::Observation& now = w.observed_by(observer_, time);
        const Instant instant{now, w, counters, 0, observer_};
        const auto& bearing = observer_.forces().bearing;
        turn(w.state());
        times.push_back(time);
        values.push_back({bearing[0].force[0], bearing[0].force[1], bearing[1].force[0], bearing[1].force[1], instant.chain_torque(0),
                          instant.chain_torque(1)});
        const double whole = 2.0 * std::numbers::pi * rounds_;
        if (times.size() == 1 || turned_ < whole) return;
        const double share = (whole - turned_before_) / (turned_ - turned_before_), before = times[times.size() - 2];
        for (std::size_t k = 0; k < signals; ++k) {
            const double last = values[values.size() - 2][k];
            values.back()[k] = last + share * (values.back()[k] - last);
        }
        times.back() = before + share * (time - before);
        complete = true;
    }
    void transition(const TransitionRecord&) override {}

    std::vector<double> times;                          ///< [s]
    std::vector<std::array<double, signals>> values{};  ///< [times]
    bool complete = false;

private:
    void turn(const double* state) {
        const model::ChainLayout& at = variator_.layout();
        const auto place = [&](int link) {
            const double* q = state + at.link_begin(link);
            return std::complex<double>(q[at.x(model::End::rear, 0)], q[at.y(model::End::rear, 0)]);
        };
        if (times.empty())
            for (int link = 0; link < at.links; ++link) middle_ += place(link) / static_cast<double>(at.links);
        const std::complex<double> arm = place(0) - middle_;
        turned_before_ = turned_;
        if (!times.empty()) turned_ += std::abs(std::arg(arm / arm_));
        arm_ = arm;
    }

    const model::Variator& variator_;
    model::Observer observer_;
    int rounds_;
    std::complex<double> middle_, arm_;
    double turned_ = 0.0, turned_before_ = 0.0;  ///< [rad]
};

/// Mean squares by order of one signal, without the straight line from its first to its last value.
OrderPowers powers_of(const RoundRecorder& run, std::size_t signal, int rounds, int last) {
    const double begin = run.times.front(), length = run.times.back() - begin;
    const double first = run.values.front()[signal], rise = run.values.back()[signal] - first;
    std::vector<std::complex<double>> sums(static_cast<std::size_t>(last) + 1);
    for (std::size_t k = 0; k + 1 < run.times.size(); ++k) {
        const double here = (run.times[k] - begin) / length;
        const double width = 0.5 * (run.times[k + 1] - run.times[k == 0 ? 0 : k - 1]) / length;  // at the ends the signal is zero
        const double value = width * (run.values[k][signal] - first - rise * here);
        const std::complex<double> turn = std::polar(1.0, -2.0 * std::numbers::pi * rounds * here);
        std::complex<double> phase = value;
        for (std::complex<double>& sum : sums) {
            sum += phase;
            phase *= turn;
        }
    }
    OrderPowers powers;
    for (const std::complex<double>& sum : sums) powers.push_back(2.0 * std::norm(sum));
    powers.front() = 0.0;
    return powers;
}

void transform(const RoundRecorder& run, int rounds, int pins, NoiseSpectrum& spectrum) {
    const int last = noise_harmonics * pins;
    spectrum.round = rounds / (run.times.back() - run.times.front());
    spectrum.force.assign(static_cast<std::size_t>(last) + 1, 0.0);
    spectrum.torque = spectrum.force;
    for (std::size_t k = 0; k < signals; ++k) {
        const OrderPowers powers = powers_of(run, k, rounds, last);
        OrderPowers& sum = k < 4 ? spectrum.force : spectrum.torque;
        for (std::size_t order = 0; order < powers.size(); ++order) sum[order] += powers[order];
    }
    spectrum.force_tone = tonality(spectrum.force, spectrum.round, pins);
    spectrum.torque_tone = tonality(spectrum.torque, spectrum.round, pins);
}

}  // namespace

NoiseSpectrum measure_noise(Scene scene, int rounds, const engine::Cancellation& cancel) {
    NoiseSpectrum spectrum;
    const auto started = std::chrono::steady_clock::now();
    scene.run.threads = 1;
    scene.run.schedule = "serial";
    scene.run.output_interval = 20e-6;
    Simulation simulation(scene);
    SilentObserver silent;
    Fault fault = simulation.needs_settling() ? simulation.advance({}, silent, cancel) : Fault{};
    RoundRecorder recorder(simulation.workspace().variator, rounds);
    model::Observer observer(simulation.workspace().variator);
    const double speed = simulation.workspace().observed_by(observer, simulation.time()).chain_speed;
    const double until = simulation.time() + 1.5 * rounds * model::chain_length(scene.parameters.chain) / speed;
    if (!fault) fault = simulation.advance({.until = until, .new_part = true, .pause = &recorder.complete}, recorder, cancel);
    spectrum.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    if (recorder.complete && simulation.balance_error_ratio() <= 1.0)
        transform(recorder, rounds, scene.parameters.chain.pins, spectrum);
    else if (recorder.complete)
        spectrum.fault = "unreliable: the energy balance does not close";
    else
        spectrum.fault = fault ? fault.message() : "the chain stops";
    return spectrum;
}

}  // namespace cvtflow::bench
