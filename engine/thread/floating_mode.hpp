#pragma once
/// Rounding and treatment of denormals (of float and double) as in the thread that called run(), so that results do not depend on which
/// thread computed them. Threads begin with the mode of their creator, but OpenMP's may be older than the run. Private to this folder.

#include <cfenv>

namespace cvtflow::engine {

class FloatingMode {
public:
    /// The calling thread's.
    FloatingMode() noexcept {
#if defined(__x86_64__)
        mode_ = __builtin_ia32_stmxcsr();
#else
        std::fegetenv(&mode_);
#endif
    }

    /// Makes it the calling thread's.
    void adopt() const noexcept {
#if defined(__x86_64__)
        if (((mode_ ^ __builtin_ia32_stmxcsr()) & ~occurred) != 0) __builtin_ia32_ldmxcsr(mode_);
#else
        std::fesetenv(&mode_);
#endif
    }

private:
#if defined(__x86_64__)
    static constexpr unsigned occurred = 0x3f;  // exceptions so far: no mode
    unsigned mode_;
#else
    std::fenv_t mode_;
#endif
};

/// Sets a mode of the calling thread, and restores the previous one when destroyed.
class FloatingScope {
public:
    explicit FloatingScope(const FloatingMode& requested) noexcept { requested.adopt(); }
    ~FloatingScope() { previous_.adopt(); }
    FloatingScope(const FloatingScope&) = delete;
    FloatingScope& operator=(const FloatingScope&) = delete;

private:
    FloatingMode previous_;
};

}  // namespace cvtflow::engine
