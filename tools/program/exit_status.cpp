#include "tools/program/exit_status.hpp"

namespace cvtflow::tools {

ExitStatus exit_status(tasks::FaultKind kind) noexcept {
    using tasks::FaultKind;
    switch (kind) {
        case FaultKind::none: return ExitStatus::finished;
        case FaultKind::non_finite:
        case FaultKind::penetration:
        case FaultKind::left_sheave:
        case FaultKind::step_size:
        case FaultKind::too_stiff:
        case FaultKind::blow_up:
        case FaultKind::step_too_short: return ExitStatus::fault;
        case FaultKind::max_steps:
        case FaultKind::max_wall: return ExitStatus::budget;
        case FaultKind::cancelled: return ExitStatus::cancelled;
    }
    return ExitStatus::error;
}

ExitStatus exit_status(const tasks::RunReport& report) noexcept {
    return report.fault || report.reliable() ? exit_status(report.fault.kind) : ExitStatus::unreliable;
}

}  // namespace cvtflow::tools
