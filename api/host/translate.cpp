#include "api/host/translate.hpp"

#include <string>

#include "engine/base/text.hpp"
#include "engine/thread/stack_left.hpp"

namespace cvtflow::api {

ErrorCode code_of(tasks::FaultKind kind) noexcept {
    using tasks::FaultKind;
    if (kind == FaultKind::none) return ErrorCode::none;
    if (kind == FaultKind::non_finite) return ErrorCode::non_finite;
    if (kind == FaultKind::penetration) return ErrorCode::penetration;
    if (kind == FaultKind::left_sheave) return ErrorCode::left_sheave;
    if (kind == FaultKind::max_steps) return ErrorCode::max_steps;
    if (kind == FaultKind::max_wall) return ErrorCode::max_wall;
    if (kind == FaultKind::cancelled) return ErrorCode::cancelled;
    if (kind == FaultKind::blow_up) return ErrorCode::blow_up;
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
