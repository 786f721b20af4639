#pragma once
/// The default floating-point environment for a while: results do not depend on what the host has set. Internal to api.

#include <cfenv>

namespace cvtflow::api {

/// Round to nearest, denormals kept, traps off; on destruction the host's environment as it was, its exception flags included.
class FloatingDefaults {
public:
    FloatingDefaults() noexcept {
        std::fegetenv(&found_);
        std::fesetenv(FE_DFL_ENV);
    }
    ~FloatingDefaults() { std::fesetenv(&found_); }
    FloatingDefaults(const FloatingDefaults&) = delete;
    FloatingDefaults& operator=(const FloatingDefaults&) = delete;

private:
    std::fenv_t found_;
};

}  // namespace cvtflow::api
