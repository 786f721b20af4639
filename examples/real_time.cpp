/// Soft real time: a variator of rigid pins beside a clock. Every cycle of 1 ms sets a load and reads a ratio; cycles that end after their
/// deadline are counted. A processor that is too slow gets a clock that is SLOWER times slower than the machine's. At the end stands what a
/// host pays beside the steps.
///
///     real_time [SLOWER [CYCLES]]     1: the machine's clock. 0 (default): 1.5 times the longest of the first cycles, at least 1

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cvtflow/cvtflow.hpp>
#include <thread>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

constexpr double cycle = 1e-3;  // [s] of the machine's time
constexpr int trials = 20;

/// Seconds of wall time for one cycle.
double take_cycle(cvtflow::Simulation& simulation, int number) {
    const auto begin = Clock::now();
    simulation.set_input(cvtflow::Input::load_torque, 60.0 + 10.0 * std::sin(0.1 * number));
    simulation.advance_to(cycle * (number + 1));
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Microseconds of wall time, the median of 21.
template <class Work>
double microseconds(const Work& work) {
    std::vector<double> times;
    for (int k = 0; k < 21; ++k) {
        const auto begin = Clock::now();
        work();
        times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - begin).count());
    }
    std::nth_element(times.begin(), times.begin() + 10, times.end());
    return times[10];
}

void print_costs(const char* scene) {
    const cvtflow::Scene read = cvtflow::Scene::ready(scene);
    double sum = 0.0;  // of what is returned, so that all of it is computed
    const double made = microseconds([&] { sum += cvtflow::Simulation(read).time(); });
    const double begun = microseconds([&] { cvtflow::Simulation(read).step(); });
    cvtflow::Simulation simulation(read);
    const double step = microseconds([&] { simulation.step(); });
    const double copy = microseconds([&] { sum += simulation.copy().time(); });
    const double state = microseconds([&] { sum += static_cast<double>(simulation.state().bytes().size()); });
    std::printf("%s: construction %.3g us, with its start and first step %.3g us, copy %.3g us, state %.3g us, step %.3g us%s\n", scene,
                made, begun, copy, state, step, std::isfinite(sum) ? "" : " (a time is not finite)");
}

}  // namespace

int main(int argc, char** argv) {
    double slower = argc > 1 ? std::atof(argv[1]) : 0.0;
    const int cycles = argc > 2 ? std::atoi(argv[2]) : 200;
    cvtflow::Simulation simulation(cvtflow::Scene::ready("drive"));
    simulation.advance_to(0.0);
    double longest = 0.0;
    int number = 0;
    for (; number < trials; ++number) longest = std::max(longest, take_cycle(simulation, number));
    if (!(slower > 0.0)) slower = std::max(1.0, 1.5 * longest / cycle);
    const std::chrono::duration<double> slot(slower * cycle);
    auto deadline = Clock::now() + slot;
    int missed = 0;
    std::vector<double> times;
    for (; number < trials + cycles; ++number) {
        const double time = take_cycle(simulation, number);
        times.push_back(time);
        if (Clock::now() > deadline) {
            ++missed;
            deadline = Clock::now();  // the next one has its whole time
        }
        std::this_thread::sleep_until(deadline);
        deadline += std::chrono::duration_cast<Clock::duration>(slot);
    }
    std::sort(times.begin(), times.end());
    const auto share = [&](double part) { return 1e3 * times[static_cast<std::size_t>(part * static_cast<double>(times.size() - 1))]; };
    std::printf(
        "%d cycles of 1 ms, clock %.3g times slower than the machine's: %d deadlines missed; a cycle took %.3g ms (median), %.3g (99.9 "
        "%%), "
        "at most %.3g; ratio %.4f\n",
        cycles, slower, missed, share(0.5), share(0.999), share(1.0), simulation.channel("ratio")[0]);
    print_costs("drive");
    print_costs("baseline");
    return 0;
}
