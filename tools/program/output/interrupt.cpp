#include "tools/program/output/interrupt.hpp"

#include <csignal>
#include <ctime>
#include <vector>

#include "engine/thread/child_process.hpp"

namespace cvtflow::tools {

namespace {

// A signal handler can reach nothing but a global.
engine::Cancellation interrupted;
double asked = 0.0;  // [s]

constexpr double insisting = 0.5;  ///< one wish may come several times: to the process, to its group, from its parent [s]

extern "C" void on_interrupt(int signal) {
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);
    const double now = static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
    if (!interrupted.requested()) {
        asked = now;
        return interrupted.request();
    }
    const bool repeats = signal == SIGXCPU || signal == SIGPIPE;  // repeated by the system every second, or with every line
    if (repeats || now < asked + insisting) return;
    std::signal(signal, SIG_DFL);
    std::raise(signal);  // delivered when the handler returns
}

}  // namespace

const engine::Cancellation& catch_interrupts() {
    struct sigaction action {};
    action.sa_handler = on_interrupt;
    sigemptyset(&action.sa_mask);
    const std::vector<int> signals = engine::ending_signals();
    for (const int signal : signals) sigaddset(&action.sa_mask, signal);
    action.sa_flags = SA_RESTART;
    for (const int signal : signals) sigaction(signal, &action, nullptr);
    return interrupted;
}

}  // namespace cvtflow::tools
