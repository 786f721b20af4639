#include "tools/guard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>

#include "engine/executor/worker_threads.hpp"
#include "tasks/run.hpp"

namespace cvtflow::tools {

void print_error(std::string_view message) {
    for (std::size_t begin = 0; begin <= message.size();) {
        const std::size_t end = std::min(message.find('\n', begin), message.size());
        const bool continued = message.substr(begin).starts_with("  ");
        fmt::print(stderr, "{}{}\n", continued ? "" : "cvtflow: ", message.substr(begin, end - begin));
        begin = end + 1;
    }
}

void print_notices() {
    const engine::ThreadShortage threads = engine::thread_shortage();
    if (threads.wanted == 0) return;
    print_error(fmt::format("the system gave {} of {} threads; this took longer and gave the same bits", threads.had, threads.wanted));
}

int guarded(const std::function<int()>& work) noexcept {
    try {
        return work();
    } catch (const tasks::SettlingFault& end) {
        print_error(end.what());
        return static_cast<int>(exit_status(end.fault.kind));
    } catch (const std::exception& error) {
        print_error(error.what());
        return static_cast<int>(ExitStatus::error);
    }
}

}  // namespace cvtflow::tools
