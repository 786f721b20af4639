#include "api/host/entry.hpp"

#include <cvtflow/error.hpp>
#include <string>

#include "engine/base/text.hpp"
#include "engine/thread/stack_left.hpp"

namespace cvtflow::api {

const char* code_name(ErrorCode code) noexcept {
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

ErrorCode code_of(const tasks::Fault& fault) {
    for (int number = 0; number < static_cast<int>(ErrorCode::other_fault); ++number) {
        const auto code = static_cast<ErrorCode>(number);
        if (fault.name() == code_name(code)) return code;
    }
    return ErrorCode::other_fault;
}

void require_stack() {
    const std::size_t left = engine::stack_left();
    if (left >= min_stack) return;
    throw Error(ErrorCode::argument, "the calling thread has " + std::to_string(left >> 10U) + " KiB of stack left; 256 KiB are needed");
}

void rethrow(ErrorCode otherwise) {
    try {
        throw;
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::memory, "no memory");
    } catch (const std::exception& error) {
        throw Error(otherwise, engine::error_text(error));
    }
}

}  // namespace cvtflow::api
