#include "tasks/batch/batch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstring>

namespace cvtflow::tasks {

namespace {

constexpr int interrupted = 130;

[[nodiscard]] std::string signal_text(int signal) {
    const char* name = sigabbrev_np(signal);
    return fmt::format("{} ({})", name != nullptr ? fmt::format("SIG{}", name) : fmt::format("signal {}", signal), strsignal(signal));
}

/// Whether it was ended by another signal than those that end a sweep.
[[nodiscard]] bool crashed(const engine::ChildEnd& end) {
    constexpr std::array requests{0, SIGINT, SIGTERM, SIGHUP, SIGXCPU, SIGPIPE};
    return std::ranges::find(requests, end.signal) == requests.end();
}

}  // namespace

int supervise(engine::SharedSlots& journal, const std::function<int(const SweepPart&)>& work,
              const std::function<void(const std::string&)>& said) {
    int attempts = 0;
    bool stopped = false;
    const auto attempt = [&](SweepPart part) {
        if (stopped) return engine::ChildEnd{interrupted};
        journal.clear();
        part.attempt = attempts++;
        const engine::ChildEnd end = engine::run_child([&] { return work(part); });
        stopped = end.interrupted;
        return end;
    };
    for (;;) {
        const engine::ChildEnd whole = attempt({});
        if (!crashed(whole)) return whole.signal != 0 ? interrupted : whole.status;
        const std::vector<long> suspects = journal.taken();
        const std::string signal = signal_text(whole.signal);
        if (suspects.empty()) {
            said(fmt::format("a process of the sweep was ended by {} outside its cases", signal));
            return 1;
        }
        said(fmt::format("a process of the sweep was ended by {}; its cases run again one by one: {} {}", signal,
                         suspects.size() == 1 ? "case" : "cases", fmt::join(suspects, ", ")));
        for (const long suspect : suspects) {
            engine::ChildEnd alone = attempt({suspect, {}});
            if (crashed(alone)) {
                const std::string of_it = signal_text(alone.signal);
                said(fmt::format("case {} crashed: {}", suspect, of_it));
                alone = attempt({suspect, fmt::format("its process was ended by {}, even when it ran alone", of_it)});
            }
            if (alone.status != 0) return alone.status;  // 0: the case has its row
        }
    }
}

}  // namespace cvtflow::tasks
