#include "tools/exit_status.hpp"

namespace cvtflow::tools {

ExitStatus exit_status(tasks::FaultKind kind) noexcept {
    using tasks::FaultKind;
    switch (kind) {
        case FaultKind::none: return ExitStatus::finished;
        case FaultKind::non_finite:
        case FaultKind::penetration:
        case FaultKind::step_size:
        case FaultKind::left_sheave: return ExitStatus::fault;
        case FaultKind::max_steps:
        case FaultKind::max_wall: return ExitStatus::budget;
        case FaultKind::cancelled: return ExitStatus::cancelled;
    }
    return ExitStatus::error;
}

}  // namespace cvtflow::tools
