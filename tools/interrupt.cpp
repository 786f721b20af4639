#include "tools/interrupt.hpp"

#include <csignal>

namespace cvtflow::tools {

namespace {

// A signal handler can reach nothing but a global.
engine::Cancellation interrupted;

extern "C" void on_interrupt(int signal) {
    if (!interrupted.requested()) return interrupted.request();
    std::signal(signal, SIG_DFL);
    std::raise(signal);  // delivered when the handler returns
}

}  // namespace

const engine::Cancellation& catch_interrupts() {
    struct sigaction action {};
    action.sa_handler = on_interrupt;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
    return interrupted;
}

}  // namespace cvtflow::tools
