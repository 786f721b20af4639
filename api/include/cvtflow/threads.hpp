#pragma once
/// Threads that run a simulation, chosen per simulation; results are bitwise the same for every choice.

namespace cvtflow {
inline namespace v0_4 {

/// Three ways to run. No way starts a thread before the first step.
///
///   caller()                Everything on the thread that calls advance_to(). Nothing to share, nothing to wait for: for hosts that have
///                           many simulations and start threads themselves.
///   current_arena(slots)    On the oneTBB arena in which advance_to() is called (the host writes
///                           arena.execute([&] { simulation.advance_to(t); })), on `slots` of its threads, the caller included. The caller
///                           runs no task of the host meanwhile (isolated). Threads of this arena that wait for other work may take part
///                           and stay until advance_to() is over: use a separate arena, or private_arena().
///   private_arena(threads)  On an arena of the simulation with `threads` threads, the caller included; 0: as many as the process may use.
///                           The host's tasks never run inside, ours never outside.
class Threads {
public:
    enum class Way { caller, current_arena, private_arena };

    [[nodiscard]] static constexpr Threads caller() noexcept { return {Way::caller, 1}; }
    [[nodiscard]] static constexpr Threads current_arena(int slots) noexcept { return {Way::current_arena, slots}; }
    [[nodiscard]] static constexpr Threads private_arena(int threads = 0) noexcept { return {Way::private_arena, threads}; }

    [[nodiscard]] constexpr Way way() const noexcept { return way_; }
    [[nodiscard]] constexpr int count() const noexcept { return count_; }

private:
    constexpr Threads(Way way, int count) noexcept : way_(way), count_(count) {}

    Way way_;
    int count_;
};

}  // namespace v0_4
}  // namespace cvtflow
