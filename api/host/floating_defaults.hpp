#pragma once
/// The default floating-point environment for a while: results do not depend on what the host has set. Internal to api.

#include <cfenv>

namespace cvtflow::api {

/// Round to nearest, denormals kept, traps off; on destruction the host's environment as it was, its exception flags included.
class FloatingDefaults {
public:
    FloatingDefaults() noexcept { enter(); }
    ~FloatingDefaults() { leave(); }
    FloatingDefaults(const FloatingDefaults&) = delete;
    FloatingDefaults& operator=(const FloatingDefaults&) = delete;

    /// The host's environment again while its callback runs, which may change it.
    class Outside {
    public:
        explicit Outside(FloatingDefaults& defaults) noexcept : defaults_(defaults) { defaults_.leave(); }
        ~Outside() { defaults_.enter(); }
        Outside(const Outside&) = delete;
        Outside& operator=(const Outside&) = delete;

    private:
        FloatingDefaults& defaults_;
    };

private:
    void enter() noexcept {
        std::fegetenv(&found_);
        std::fesetenv(FE_DFL_ENV);
    }
    void leave() noexcept { std::fesetenv(&found_); }

    std::fenv_t found_;
};

}  // namespace cvtflow::api
