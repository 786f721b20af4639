#pragma once
/// Options of an executor that a user may set.

namespace cvtflow::engine {

class StampRecorder;

/// Way in which a thread waits for others. It always begins with pauses (the processor rests, the thread stays) and then yields (others may
/// use the processor), so that threads that outnumber processors make progress under every policy.
enum class Wait {
    spin,      ///< pauses for 2 ms: least latency, for an exclusive machine
    balanced,  ///< pauses for 20 µs, about the longest wait between two cycles of a step, then yields
    passive,   ///< pauses for 5 µs, yields for 100 µs, then sleeps in slices of 50 µs: for shared machines
};

/// Waits inside oneTBB and OpenMP do not follow `wait`; theirs are set by the environment (OMP_WAIT_POLICY, GOMP_SPINCOUNT).
struct ExecutorOptions {
    int threads = 1;  ///< ≥ 1, the calling thread included; a limit, not a demand
    Wait wait = Wait::balanced;
    double spin = -1.0;                 ///< time of pauses before the first yield [µs]; negative: the policy's
    bool pin = false;                   ///< each thread on one processor during run(); masks are restored afterwards
    bool present_arena = false;         ///< oneTBB only: runs in the arena of the caller, isolated; `pin` is ignored
    StampRecorder* recorder = nullptr;  ///< times of tasks go there; has at least `threads` tracks and outlives the executor
};

}  // namespace cvtflow::engine
