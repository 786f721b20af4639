#include "tools/program/guard.hpp"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <system_error>

#include "engine/base/text.hpp"
#include "engine/thread/worker_threads.hpp"
#include "tasks/run/run.hpp"

namespace cvtflow::tools {
namespace {

std::string_view name_in_messages = "cvtflow";

}  // namespace

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
        return static_cast<int>(exit_status(end.fault.kind));
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

}  // namespace cvtflow::tools
