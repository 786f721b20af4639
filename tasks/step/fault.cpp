#include "tasks/step/fault.hpp"

#include <fmt/format.h>

#include <iterator>

namespace cvtflow::tasks {

std::string Fault::name() const {
    static constexpr const char* names[] = {"none",      "non_finite", "penetration", "left_sheave",    "max_steps", "max_wall",
                                            "cancelled", "step_size",  "blow_up",     "step_too_short", "not_steady"};
    static_assert(std::size(names) == static_cast<std::size_t>(FaultKind::not_steady) + 1);
    return names[static_cast<std::size_t>(kind)];
}

namespace {

/// when: "at t = 0.1 s"; value: largest error over its limit [1], revolutions of the chain [1]; 0: it slides, value is its slip
std::string unsteady_text(const std::string& when, double value, double revolutions) {
    if (revolutions == 0.0)
        return fmt::format("the chain slides {}, and ever faster: it slips by {:.3g} %, and no mean of that is steady", when,
                           100.0 * value);
    if (value == 0.0) return fmt::format("the chain moves too little {} for means of whole pin periods", when);
    if (value <= 1.0) return fmt::format("the tensions swing from pin to pin {}, and more and more", when);
    return fmt::format(
        "the means are not steady {}, after {:.3g} revolutions of the chain (run.steady_limit): their largest error is {:.2g} times "
        "run.steady",
        when, revolutions, value);
}

}  // namespace

std::string Fault::message() const {
    const std::string when = fmt::format("at t = {:.9g} s", time);
    switch (kind) {
        case FaultKind::none: return "finished";
        case FaultKind::non_finite:
            return fmt::format("the state of {} is not finite {}: the step is too long for this scene, or a parameter is too large",
                               pin ? fmt::format("pin {}", *pin) : "the pulleys", when);
        case FaultKind::penetration:
            return fmt::format(
                "a tip of pin {} is {:.3g} m deep in its sheave {} (limit tip.deepest = {:.3g} m): clamping force or step is too large, or "
                "damping of the contacts too small (chain.damping_ratio)",
                *pin, value, when, limit);
        case FaultKind::left_sheave:
            return fmt::format("pin {} runs on a radius of {:.4g} m {}, off the sheave (limit {:.4g} m)", *pin, value, when, limit);
        case FaultKind::max_steps: return fmt::format("the budget of {:.0f} steps (run.max_steps) is used up {}", limit, when);
        case FaultKind::max_wall: return fmt::format("the budget of {:.3g} s of wall time (run.max_wall) is used up {}", limit, when);
        case FaultKind::cancelled: return fmt::format("cancelled {}", when);
        case FaultKind::step_size:
            return fmt::format("the step would have to be shorter than {:.1e} s {} to meet run.tolerance", limit, when);
        case FaultKind::blow_up:
            return fmt::format(
                "pin {} moves at {:.3g} m/s {} (limit {:.3g} m/s, faster than sound in steel): the step is too long for this scene", *pin,
                value, when, limit);
        case FaultKind::step_too_short:
            return fmt::format("a step of {:.3g} s is lost in the rounding of the time {} (limit {:.3g} s)", value, when, limit);
        case FaultKind::not_steady: return unsteady_text(when, value, limit);
    }
    return "unknown fault";
}

}  // namespace cvtflow::tasks
