#include "engine/thread/child_process.hpp"

#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <new>
#include <system_error>

namespace cvtflow::engine {

SharedSlots::SharedSlots(int count) {
    const auto size = static_cast<std::size_t>(std::max(1, count));
    void* memory = mmap(nullptr, size * sizeof(long), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    slots_ = {static_cast<long*>(memory), size};
    clear();
}

SharedSlots::~SharedSlots() { munmap(slots_.data(), slots_.size_bytes()); }

void SharedSlots::set(int slot, long number) noexcept {
    std::atomic_ref(slots_[static_cast<std::size_t>(slot)]).store(number, std::memory_order_relaxed);
}

void SharedSlots::clear() noexcept { std::fill(slots_.begin(), slots_.end(), none); }

std::vector<long> SharedSlots::taken() const {
    std::vector<long> numbers;
    std::copy_if(slots_.begin(), slots_.end(), std::back_inserter(numbers), [](long number) { return number != none; });
    std::sort(numbers.begin(), numbers.end());
    return numbers;
}

std::vector<int> ending_signals() {
    std::vector<int> signals{SIGINT, SIGTERM};
    for (const int other : {SIGHUP, SIGXCPU, SIGPIPE}) {
        struct sigaction now {};
        if (sigaction(other, nullptr, &now) == 0 && now.sa_handler != SIG_IGN) signals.push_back(other);
    }
    return signals;
}

namespace {

volatile std::sig_atomic_t child_at_work = 0, requested = 0;  // a signal handler can reach nothing but globals

void hand_on(int signal, siginfo_t* from, void* /*context*/) {
    requested = 1;
    if (from->si_code <= 0 && child_at_work > 0) kill(child_at_work, signal);
}

/// Hands signals on as long as it lives; keeps them back while it is held.
class Forwarding {
public:
    Forwarding() {
        sigset_t all;
        sigemptyset(&all);
        for (const int signal : signals_) sigaddset(&all, signal);
        sigprocmask(SIG_BLOCK, &all, &mask_);
        struct sigaction action {};
        action.sa_sigaction = hand_on;
        action.sa_flags = SA_SIGINFO | SA_RESTART;
        sigemptyset(&action.sa_mask);
        for (std::size_t i = 0; i < signals_.size(); ++i) sigaction(signals_[i], &action, &before_[i]);
    }
    ~Forwarding() { undo(); }
    Forwarding(const Forwarding&) = delete;
    Forwarding& operator=(const Forwarding&) = delete;

    /// Delivers the signals that were held back.
    void release() noexcept { sigprocmask(SIG_SETMASK, &mask_, nullptr); }
    void undo() noexcept {
        for (std::size_t i = 0; i < signals_.size(); ++i) sigaction(signals_[i], &before_[i], nullptr);
        release();
    }

private:
    std::vector<int> signals_ = ending_signals();
    std::vector<struct sigaction> before_{signals_.size()};
    sigset_t mask_;
};

/// The child's whole life: it must not unwind into what its parent had begun.
[[noreturn]] void live(pid_t parent, const std::function<int()>& work) noexcept {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);  // the parent died before that took effect
    const int status = work();
    std::fflush(nullptr);
    _exit(status);
}

}  // namespace

ChildEnd run_child(const std::function<int()>& work) {
    std::fflush(nullptr);
    const pid_t parent = getpid();
    Forwarding forwarding;
    requested = 0;
    const pid_t child = fork();
    if (child < 0) throw std::system_error(errno, std::generic_category(), "cannot start a process");
    if (child == 0) {
        forwarding.undo();
        live(parent, work);
    }
    child_at_work = child;
    forwarding.release();
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {}
    child_at_work = 0;
    const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    return {signal != 0 ? 128 + signal : WEXITSTATUS(status), signal, requested != 0};
}

}  // namespace cvtflow::engine
