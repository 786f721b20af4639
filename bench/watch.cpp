/// Cost of the energy watch and of the automatic step: the same steps with and without, in turns.
///
///     bench_watch [ROUNDS]

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <vector>

#include "engine/record/run/state_file.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/ready_scenes.hpp"

namespace {

using namespace cvtflow::tasks;

const cvtflow::engine::Cancellation never;

struct Spread {
    double median, low, high;  ///< quartiles
};

Spread spread(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const auto at = [&](double share) { return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))]; };
    return {at(0.5), at(0.25), at(0.75)};
}

/// Wall time of a span of simulated time from a settled start [s].
class Stretch {
public:
    Stretch(const Scene& scene, const cvtflow::engine::SavedState& start, bool watch)
        : scene_(scene), start_(start), simulation_(scene, Schedule{}) {
        simulation_.keep_energies(watch);
    }
    double run(double span) {
        simulation_.reset(scene_, &start_);
        SilentObserver silent;
        const auto begin = std::chrono::steady_clock::now();
        if (const Fault fault = simulation_.advance({.until = simulation_.time() + span}, silent, never))
            throw SimulationError(fault.message());
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    }
    [[nodiscard]] double step() const { return simulation_.step(); }

private:
    Scene scene_;
    const cvtflow::engine::SavedState& start_;
    Simulation simulation_;
};

void measure(const std::string& name, const std::string& method, double span, int rounds) {
    Scene scene = read_scene(find_scene(name));
    set_values(scene,
               std::vector<std::string>{"run.method=" + method, "run.step=auto", "run.schedule=serial", "run.output_interval=20 us"});
    Simulation settled(scene, Schedule{});
    SilentObserver silent;
    if (settled.needs_settling() && settled.advance({.until = 0.0}, silent, never)) throw SimulationError("settling");
    const cvtflow::engine::SavedState start = settled.saved_state();
    Stretch automatic(scene, start, true);
    automatic.run(span);
    Scene fixed = scene;
    fixed.run.step = automatic.step();
    Stretch with(fixed, start, true), without(fixed, start, false);
    std::vector<double> watch, choice;
    for (int round = 0; round < rounds; ++round) {
        const double a = automatic.run(span), b = with.run(span), c = without.run(span);
        choice.push_back(100.0 * (a / b - 1.0));
        watch.push_back(100.0 * (b / c - 1.0));
    }
    const Spread w = spread(watch), s = spread(choice);
    fmt::print(
        "{:<10} {:<20} {:>6.3g} ms {:>9.3g} s   watch {:>+6.2f} % ({:+.2f} … {:+.2f})   automatic step {:>+6.2f} % ({:+.2f} … {:+.2f})\n",
        name, method, 1e3 * span, automatic.step(), w.median, w.low, w.high, s.median, s.low, s.high);
    std::fflush(stdout);
}

}  // namespace

int main(int count, char** words) {
    const int rounds = count > 1 ? std::max(1, std::atoi(words[1])) : 21;
    fmt::print("cost over the same steps without, medians and quartiles of {} rounds in turns\n", rounds);
    measure("baseline", "leapfrog-chebyshev", 10e-3, rounds);
    measure("baseline", "rk4", 1e-3, rounds);
    measure("control", "leapfrog-chebyshev", 10e-3, rounds);
    measure("tiny", "leapfrog-chebyshev", 20e-3, rounds);
    measure("tiny", "rk4", 4e-3, rounds);
}
