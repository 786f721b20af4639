/// Soft real time: a variator beside a clock. Every cycle of 1 ms asks for a load and gives back a ratio; cycles that take longer than they
/// may are counted. A machine that is simulated N times slower than it runs is run N times slower.
///
///     real_time [SLOWER [CYCLES]]     0: as slow as it takes to miss few deadlines, found in the first cycles

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cvtflow/cvtflow.hpp>
#include <thread>

namespace {

using Clock = std::chrono::steady_clock;

constexpr double cycle = 1e-3;  // [s] of the machine's time
constexpr int trials = 3;

/// Seconds of wall time for one cycle.
double take_cycle(cvtflow::Simulation& simulation, int number) {
    const auto begin = Clock::now();
    simulation.set_input(cvtflow::Input::load_torque, 10.0 + 2.0 * std::sin(0.1 * number));
    simulation.advance_to(cycle * (number + 1));
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

}  // namespace

int main(int argc, char** argv) {
    double slower = argc > 1 ? std::atof(argv[1]) : 0.0;
    const int cycles = argc > 2 ? std::atoi(argv[2]) : 20;
    cvtflow::Simulation simulation(cvtflow::Scene::ready("tiny"));
    simulation.advance_to(0.0);
    double longest = 0.0;
    int number = 0;
    for (; number < trials; ++number) longest = std::max(longest, take_cycle(simulation, number));
    if (!(slower > 0.0)) slower = std::ceil(1.5 * longest / cycle);
    const std::chrono::duration<double> slot(slower * cycle);
    auto deadline = Clock::now() + slot;
    int missed = 0;
    for (; number < trials + cycles; ++number) {
        take_cycle(simulation, number);
        if (Clock::now() > deadline) {
            ++missed;
            deadline = Clock::now();  // the next one has its whole time
        }
        std::this_thread::sleep_until(deadline);
        deadline += std::chrono::duration_cast<Clock::duration>(slot);
    }
    std::printf("%d cycles of 1 ms, %g times slower than the machine: %d deadlines missed, ratio %.4f\n", cycles, slower, missed,
                simulation.channel("ratio")[0]);
    return 0;
}
