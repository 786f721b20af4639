#include "bench/study/noise/measured_noise.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <complex>
#include <numbers>

#include "tasks/channel/channels.hpp"
#include "tasks/run/simulation.hpp"

namespace cvtflow::bench {

using namespace tasks;

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
