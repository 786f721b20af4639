#include "bench/count/instructions.hpp"

#if defined(__linux__) && defined(__x86_64__)
#include <sys/ptrace.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdint>
#endif

namespace cvtflow::bench {

#if defined(__linux__) && defined(__x86_64__)

namespace {

/// Operation, kind (1: packed doubles, 3: one double) and length (0: 128 bits, 1: 256, 2: 512) of an instruction of the 0F map.
struct Arithmetic {
    std::uint8_t operation = 0;
    int kind = 0;
    int length = 0;
};

/// Intel's manual, volume 2: legacy (66 or F2, perhaps REX, 0F), two- and three-byte VEX, EVEX.
Arithmetic decode(const std::uint8_t* code) {
    if (code[0] == 0xc5) return {code[2], code[1] & 3, code[1] >> 2 & 1};
    if (code[0] == 0xc4 && (code[1] & 0x1f) == 1) return {code[3], code[2] & 3, code[2] >> 2 & 1};
    if (code[0] == 0x62 && (code[1] & 7) == 1) return {code[4], code[2] & 3, code[3] >> 5 & 3};
    if (code[0] != 0x66 && code[0] != 0xf2) return {};
    const int rex = (code[1] & 0xf0) == 0x40 ? 1 : 0;
    if (code[1 + rex] != 0x0f) return {};
    return {code[2 + rex], code[0] == 0x66 ? 1 : 3, 0};
}

long flops(const std::uint8_t* code) {
    const Arithmetic a = decode(code);
    constexpr std::array<std::uint8_t, 5> operations{0x51, 0x58, 0x59, 0x5c, 0x5e};  // sqrt, add, mul, sub, div
    for (const std::uint8_t operation : operations) {
        if (a.operation == operation) return a.kind == 1 ? 2L << a.length : a.kind == 3 ? 1 : 0;
    }
    return 0;
}

/// The child: once at full speed, so that nothing is resolved or paged in later; then traced.
[[noreturn]] void traced(const std::function<void()>& body) {
    if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) _exit(1);
    body();
    std::raise(SIGSTOP);
    body();
    std::raise(SIGSTOP);
    _exit(0);
}

std::optional<Counted> follow(pid_t child) {
    Counted counted;
    int status = 0;
    if (waitpid(child, &status, 0) != child || !WIFSTOPPED(status)) return {};
    while (true) {
        if (ptrace(PTRACE_SINGLESTEP, child, nullptr, nullptr) != 0) return {};
        if (waitpid(child, &status, 0) != child || !WIFSTOPPED(status)) return {};
        if (WSTOPSIG(status) == SIGSTOP) return counted;
        user_regs_struct registers;
        ptrace(PTRACE_GETREGS, child, nullptr, &registers);
        ++counted.instructions;
        counted.flops += flops(reinterpret_cast<const std::uint8_t*>(registers.rip));  // a fork: its code lies where ours does
    }
}

std::optional<Counted> count_all(const std::function<void()>& body) {
    const pid_t child = fork();
    if (child < 0) return {};
    if (child == 0) traced(body);
    const auto counted = follow(child);
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    return counted;
}

}  // namespace

std::optional<Counted> count(const std::function<void()>& body) {
    const auto all = count_all(body);
    const auto nothing = count_all([] {});
    if (!all || !nothing) return {};
    return Counted{all->instructions - nothing->instructions, all->flops - nothing->flops};
}

#else

std::optional<Counted> count(const std::function<void()>&) { return {}; }

#endif

}  // namespace cvtflow::bench
