#include "tasks/batch/supervisor.hpp"

#include <fmt/format.h>

#include <csignal>
#include <cstring>
#include <utility>

namespace cvtflow::tasks {

namespace {

constexpr int interrupted = 130;

[[nodiscard]] std::string signal_text(int signal) {
    const char* name = sigabbrev_np(signal);
    return fmt::format("{} ({})", name != nullptr ? fmt::format("SIG{}", name) : fmt::format("signal {}", signal), strsignal(signal));
}

[[nodiscard]] bool crashed(const engine::ChildEnd& end) { return end.signal != 0 && end.signal != SIGINT && end.signal != SIGTERM; }

/// The children of one sweep.
class Children {
public:
    Children(engine::SharedSlots& journal, const std::function<int(const SweepPart&)>& work,
             const std::function<void(const std::string&)>& said)
        : journal_(journal), work_(work), said_(said) {}

    int run() {
        for (;;) {
            const engine::ChildEnd whole = attempt({});
            if (!crashed(whole)) return whole.status;
            const std::vector<long> suspects = journal_.taken();
            const std::string signal = signal_text(whole.signal);
            if (suspects.empty()) {
                said_(fmt::format("a process of the sweep was ended by {} outside its cases", signal));
                return 1;
            }
            said_(fmt::format("a process of the sweep was ended by {}; its cases run again one by one: {} {}", signal,
                              suspects.size() == 1 ? "case" : "cases", fmt::join(suspects, ", ")));
            for (const long suspect : suspects) {
                if (const int status = alone(suspect); status != 0) return status;
            }
        }
    }

private:
    engine::ChildEnd attempt(SweepPart part) {
        if (interrupted_) return {interrupted};
        journal_.clear();
        part.attempt = attempts_++;
        const engine::ChildEnd end = engine::run_child([&] { return work_(part); });
        interrupted_ = end.interrupted;
        return end;
    }

    /// @return 0: the case has its row
    int alone(long suspect) {
        const engine::ChildEnd end = attempt({suspect, {}});
        if (!crashed(end)) return end.status;
        const std::string signal = signal_text(end.signal);
        said_(fmt::format("case {} crashed: {}", suspect, signal));
        return attempt({suspect, fmt::format("its process was ended by {}, even when it ran alone", signal)}).status;
    }

    engine::SharedSlots& journal_;
    const std::function<int(const SweepPart&)>& work_;
    const std::function<void(const std::string&)>& said_;
    int attempts_ = 0;
    bool interrupted_ = false;
};

}  // namespace

int supervise(engine::SharedSlots& journal, const std::function<int(const SweepPart&)>& work,
              const std::function<void(const std::string&)>& said) {
    return Children(journal, work, said).run();
}

}  // namespace cvtflow::tasks
