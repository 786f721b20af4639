#include "tools/program/guard.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <exception>
#include <vector>

#include "engine/base/text.hpp"
#include "engine/thread/child_process.hpp"
#include "engine/thread/worker_threads.hpp"
#include "tasks/run/run.hpp"

namespace cvtflow::tools {

namespace {

std::string_view name_in_messages = "cvtflow";

// A signal handler can reach nothing but a global.
engine::Cancellation interrupted;
double asked = 0.0;  // [s]

constexpr double insisting = 0.5;  ///< a request may arrive several times: to the process, to its group, from its parent [s]

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

ExitStatus status_of(tasks::FaultKind kind) noexcept {
    using tasks::FaultKind;
    switch (kind) {
        case FaultKind::none: return ExitStatus::finished;
        case FaultKind::max_steps:
        case FaultKind::max_wall: return ExitStatus::budget;
        case FaultKind::not_steady: return ExitStatus::inaccurate;
        case FaultKind::cancelled: return ExitStatus::cancelled;
        default: return ExitStatus::fault;  // the simulation cannot continue
    }
}

}  // namespace

ExitStatus exit_status(const tasks::RunReport& report) noexcept {
    if (report.fault) return status_of(report.fault.kind);
    return !report.reliable() ? ExitStatus::unreliable : report.whole.cycle_missed() ? ExitStatus::missed : ExitStatus::finished;
}

std::string exit_status_table() {
    constexpr std::size_t indent = 7, width = 80;
    std::string table = "Exit status:";
    for (const auto& [status, meaning] : tasks::exit_statuses) {
        std::string line = fmt::format("\n  {:<5}", static_cast<int>(status));
        std::size_t column = indent;
        for (const std::string& word : engine::words_of(meaning)) {
            const bool fits = column + word.size() < width;
            line += column == indent ? word : fits ? " " + word : "\n" + std::string(indent, ' ') + word;
            column = (fits ? column : indent) + word.size() + 1;
        }
        table += line;
    }
    return table;
}

void name_program(std::string_view name) noexcept { name_in_messages = name; }
std::string_view program_name() noexcept { return name_in_messages; }

void to_stderr(std::string_view text) noexcept {
    if (std::fwrite(text.data(), 1, text.size(), stderr) != text.size()) std::clearerr(stderr);
    std::fflush(stderr);
}

void print_error(std::string_view message) {
    for (std::size_t begin = 0; begin <= message.size();) {
        const std::size_t end = std::min(message.find('\n', begin), message.size());
        const bool continued = message.substr(begin).starts_with("  ");
        to_stderr(fmt::format("{}{}{}\n", continued ? "" : program_name(), continued ? "" : ": ",
                              engine::visible(message.substr(begin, end - begin))));
        begin = end + 1;
    }
}

void say(bool quiet, std::string_view message) {
    if (!quiet && !message.empty()) print_error(message);
}

void print_notices() {
    const engine::ThreadShortage threads = engine::thread_shortage();
    if (threads.requested == 0) return;
    print_error(
        fmt::format("only {} of {} threads were available: the run took longer, its results are the same", threads.had, threads.requested));
}

int guarded(const std::function<int()>& work) noexcept {
    try {
        return work();
    } catch (const tasks::SettlingFault& end) {
        print_error(end.what());
        return static_cast<int>(status_of(end.fault.kind));
    } catch (const UsageError& error) {
        print_error(error.what());
        return static_cast<int>(ExitStatus::usage);
    } catch (const std::bad_alloc&) {
        to_stderr(program_name());
        to_stderr(": out of memory\n");
    } catch (const std::exception& error) {
        print_error(engine::error_text(error));
    } catch (...) {
        to_stderr(program_name());
        to_stderr(": an exception of unknown type\n");
    }
    return static_cast<int>(ExitStatus::error);
}

void take_standard_descriptors() noexcept {
    std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit of file sizes fails then, and is reported like a full disk
    for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (fcntl(number, F_GETFD) < 0 && errno == EBADF)
            static_cast<void>(open("/dev/null", number == STDIN_FILENO ? O_WRONLY : O_RDONLY));  // the lowest free one
    }
}

int finish_output(int status) noexcept {
    errno = 0;
    const bool failed = std::fflush(stdout) != 0;
    if (!failed && std::ferror(stdout) == 0) return status;
    try {
        const int reason = errno;  // EBADF: the parent closed it (take_standard_descriptors)
        print_error(fmt::format("standard output: cannot write{}{}", reason != 0 ? ": " : "",
                                reason == EBADF ? "it is closed"
                                : reason != 0   ? std::strerror(reason)
                                                : ""));
    } catch (const std::exception&) {
        // no memory for a message; the exit status reports the failure
    }
    return status != 0 ? status : static_cast<int>(ExitStatus::error);
}

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
