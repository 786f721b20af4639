#include <cvtflow/error.hpp>

namespace cvtflow {
inline namespace v0 {

Error::Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
Error::~Error() = default;

const char* error_name(ErrorCode code) noexcept {
    switch (code) {
        case ErrorCode::none: return "none";
        case ErrorCode::argument: return "argument";
        case ErrorCode::scene: return "scene";
        case ErrorCode::start_state: return "start_state";
        case ErrorCode::state: return "state";
        case ErrorCode::busy: return "busy";
        case ErrorCode::forked: return "forked";
        case ErrorCode::cancelled: return "cancelled";
        case ErrorCode::memory: return "memory";
        case ErrorCode::internal: return "internal";
        case ErrorCode::callback: return "callback";
        case ErrorCode::record: return "record";
        case ErrorCode::non_finite: return "non_finite";
        case ErrorCode::penetration: return "penetration";
        case ErrorCode::left_sheave: return "left_sheave";
        case ErrorCode::max_steps: return "max_steps";
        case ErrorCode::max_wall: return "max_wall";
        case ErrorCode::blow_up: return "blow_up";
        case ErrorCode::other_fault: return "other_fault";
    }
    return "unknown";
}

}  // namespace v0
}  // namespace cvtflow
