// A host that starts threads: each runs a variator and holds its ratio with a controller, 1,000 times a second.
//
// The scene `shift` has too little clamping: left alone, the ratio drifts away. Every millisecond the host reads the ratio and sets the
// clamping force of the driving shaft. The simulations run on the threads that the host already has (Threads::caller()) and know nothing of
// each other.
//
//     host_threads [THREADS [MILLISECONDS]]

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cvtflow/cvtflow.hpp>
#include <string>
#include <thread>
#include <vector>

namespace {

struct Outcome {
    double target = 0.0, begin = 0.0, end = 0.0, clamping = 0.0;
    std::string error;
};

/// PI controller of the ratio by the clamping force S_1.
class RatioController {
public:
    RatioController(double target, double clamping) : target_(target), clamping_(clamping) {}
    /// The clamping force for the next period. @param ratio now   @param period [s]
    double operator()(double ratio, double period) {
        const double error = (ratio - target_) / target_;
        integral_ += error * period;
        return std::clamp(clamping_ + 2e5 * error + 4e7 * integral_, 5e3, 60e3);
    }

private:
    double target_, clamping_, integral_ = 0.0;
};

Outcome hold_ratio(const cvtflow::Scene& scene, double target, int periods) {
    Outcome outcome{target, 0.0, 0.0, 0.0, ""};
    try {
        cvtflow::Simulation simulation(scene);  // on this thread alone
        constexpr double period = 1e-3;
        RatioController controller(target, simulation.input(cvtflow::Input::clamping_driving));
        const std::size_t ratio = simulation.find_channel("ratio");
        const double begin = simulation.time();
        outcome.begin = simulation.channel(ratio)[0];
        for (int k = 1; k <= periods; ++k) {
            simulation.set_input(cvtflow::Input::clamping_driving, controller(simulation.channel(ratio)[0], period));
            simulation.advance_to(begin + k * period);
        }
        outcome.end = simulation.channel(ratio)[0];
        outcome.clamping = simulation.input(cvtflow::Input::clamping_driving);
    } catch (const cvtflow::Error& error) {
        outcome.error = error.what();
    }
    return outcome;
}

}  // namespace

int main(int argc, char** argv) try {
    const int threads = argc > 1 ? std::atoi(argv[1]) : 2;
    const int periods = argc > 2 ? std::atoi(argv[2]) : 20;
    const std::vector<std::string> settings{"run.method=dumka3-p5", "run.step=2 us"};
    const cvtflow::Scene scene = cvtflow::Scene::ready("shift").with(settings);  // one scene, shared by all threads
    std::vector<Outcome> outcomes(static_cast<std::size_t>(threads));
    {
        std::vector<std::jthread> team;
        for (int k = 0; k < threads; ++k) {
            team.emplace_back([&, k] { outcomes[static_cast<std::size_t>(k)] = hold_ratio(scene, 1.0 + 0.002 * k, periods); });
        }
    }
    std::printf("thread   target    at start  after %d ms   clamping S_1\n", periods);
    int failed = 0;
    for (std::size_t k = 0; k < outcomes.size(); ++k) {
        const Outcome& o = outcomes[k];
        if (o.error.empty()) {
            std::printf("%6zu   %.4f    %.4f    %.4f      %8.0f N\n", k, o.target, o.begin, o.end, o.clamping);
        } else {
            std::printf("%6zu   %s\n", k, o.error.c_str());
        }
        failed += o.error.empty() ? 0 : 1;
    }
    return failed;
} catch (const cvtflow::Error& error) {
    std::fprintf(stderr, "host_threads: %s\n", error.what());
    return 1;
}
