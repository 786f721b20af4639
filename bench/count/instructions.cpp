#include "bench/count/instructions.hpp"

#if defined(__linux__) && defined(__x86_64__)
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <ucontext.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdint>
#include <stdexcept>
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

Counted tally;  // counts of the child process

/// Counts an instruction, after each one while the trap flag is set. The next instruction is at the saved program counter.
void after_instruction(int, siginfo_t*, void* context) {
    ++tally.instructions;
    tally.flops += flops(reinterpret_cast<const std::uint8_t*>(static_cast<ucontext_t*>(context)->uc_mcontext.gregs[REG_RIP]));
}

/// Sets or clears the trap flag; below the 128 bytes that a function may use under its stack pointer.
void trap(bool on) noexcept {
    if (on)
        asm volatile("lea -128(%%rsp), %%rsp; pushfq; orl $0x100, (%%rsp); popfq; lea 128(%%rsp), %%rsp" ::: "memory", "cc");
    else
        asm volatile("lea -128(%%rsp), %%rsp; pushfq; andl $0xfffffeff, (%%rsp); popfq; lea 128(%%rsp), %%rsp" ::: "memory", "cc");
}

/// The child: every body once at full speed, so that nothing is resolved or paged in later; then counted.
[[noreturn]] void count_here(std::span<const std::function<void()>> bodies, Counted* counted) {
    struct sigaction action {};
    action.sa_sigaction = after_instruction;
    action.sa_flags = SA_SIGINFO;
    if (sigaction(SIGTRAP, &action, nullptr) != 0) _exit(1);
    for (const auto& body : bodies) {
        body();
        tally = {};
        trap(true);
        body();
        trap(false);
        *counted++ = tally;
    }
    _exit(0);
}

std::vector<Counted> count_all(std::span<const std::function<void()>> bodies) {
    const std::size_t bytes = bodies.size() * sizeof(Counted);
    void* const shared = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) return {};
    auto* const counted = static_cast<Counted*>(shared);
    const pid_t child = fork();
    if (child == 0) count_here(bodies, counted);
    int status = -1;
    const bool ended = child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
    const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : SIGTRAP;
    std::vector<Counted> all;
    if (ended) all.assign(counted, counted + bodies.size());
    munmap(shared, bytes);
    if (signal != SIGTRAP) throw std::runtime_error(fmt::format("code whose instructions were counted ended by signal {}", signal));
    return all;
}

}  // namespace

std::vector<Counted> count_each(std::span<const std::function<void()>> bodies) {
    std::vector<std::function<void()>> with_nothing(bodies.begin(), bodies.end());
    with_nothing.emplace_back([] {});
    std::vector<Counted> counted = count_all(with_nothing);
    if (counted.empty()) return {};
    const Counted nothing = counted.back();
    counted.pop_back();
    for (Counted& each : counted) each = {each.instructions - nothing.instructions, each.flops - nothing.flops};
    return counted;
}

#else

std::vector<Counted> count_each(std::span<const std::function<void()>>) { return {}; }

#endif

std::optional<Counted> count(const std::function<void()>& body) {
    const std::vector<Counted> counted = count_each({&body, 1});
    return counted.empty() ? std::optional<Counted>() : counted.front();
}

}  // namespace cvtflow::bench
