/// A host without files or other libraries: a time step of 1 ms, an input from outside, and two futures of one state.
/// Links cvtflow::core or cvtflow::core_shared (package cvtflow-core).
///
///     core_host SCENE.toml [--costs]    --costs: also what copies, states and calls take, and 100 copies on threads of the host
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cvtflow/error.hpp>
#include <cvtflow/simulation.hpp>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

namespace {

/// Prints the median time of a call.
template <class Call>
void print_cost(const char* name, const Call& call) {
    std::vector<double> times;  // [us]
    for (int k = 0; k < 101; ++k) {
        const auto begin = std::chrono::steady_clock::now();
        call();
        times.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count());
    }
    std::nth_element(times.begin(), times.begin() + 50, times.end());
    std::printf("%-20s %7.1f us\n", name, times[50]);
}

/// Prints the time in which 100 copies advance by 1 ms, shared by threads of the host.
void print_fleet(const cvtflow::Simulation& origin, int threads) {
    std::vector<cvtflow::Simulation> fleet;
    for (int k = 0; k < 100; ++k) fleet.push_back(origin.copy());
    const double until = origin.time() + 1e-3;
    const auto begin = std::chrono::steady_clock::now();
    {
        std::vector<std::jthread> hosts;
        for (int host = 0; host < threads; ++host)
            hosts.emplace_back([&, host] {
                for (std::size_t k = host; k < fleet.size(); k += threads) fleet[k].advance_to(until);
            });
    }
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    for (const cvtflow::Simulation& each : fleet)
        if (each.hash() != fleet.front().hash()) throw cvtflow::Error(cvtflow::ErrorCode::internal, "copies differ");
    std::printf("100 x 1 ms, %d thread%s %7.1f ms\n", threads, threads > 1 ? "s" : " ", took.count());
}

}  // namespace

int main(int count, char** arguments) try {
    if (count < 2) return 2;
    std::ifstream file(arguments[1]);  // the host reads files; the library takes text
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const cvtflow::Scene scene =
        cvtflow::Scene::parse(text, arguments[1]).with("start.state=\"\"").with("start.settling_time=5 ms").with_detail("rigid");
    cvtflow::Simulation now(scene);
    now.advance_to(0.0);  // settles
    now.advance_to(1e-3);

    cvtflow::Simulation future = now.copy();  // costs less than a millisecond
    future.set_input(cvtflow::Input::load_torque, 1.1 * now.input(cvtflow::Input::load_torque));
    for (cvtflow::Simulation* each : {&now, &future}) {
        each->advance_to(2e-3);
        std::printf("load %6.2f N m: slip %.6f\n", each->input(cvtflow::Input::load_torque), each->channel("slip")[0]);
    }
    if (count > 2 && arguments[2] == std::string("--costs")) {
        print_cost("Simulation(scene)", [&] { const cvtflow::Simulation another(scene); });
        print_cost("copy()", [&] { const cvtflow::Simulation another = now.copy(); });
        print_cost("state()", [&] { const cvtflow::State state = now.state(); });
        const auto steps = [&now](int count, bool each) {
            const double until = now.time() + (count - 0.5) * now.step_length();
            for (int k = 0; each && k < count; ++k) now.step();
            now.advance_to(until);
        };
        print_cost("20 steps, 1 call", [&] { steps(20, false); });
        print_cost("20 steps, 20 calls", [&] { steps(20, true); });
        const auto allocated = [] { return mallinfo2().uordblks + mallinfo2().hblkhd; };
        const std::size_t before = allocated();
        const cvtflow::Simulation another = now.copy();
        std::printf("%-20s %7.1f kB\n", "memory of a copy", 1e-3 * static_cast<double>(allocated() - before));
        for (const int threads : {1, 2}) print_fleet(now, threads);
        print_cost("set_state()", [&now, state = now.state()] { now.set_state(state); });
    }
    return 0;
} catch (const cvtflow::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
