#pragma once
/// The serial part of finding and carrying out transitions: what is done between detect, locate and truncate cycles.

#include "tasks/step/control/run_observer.hpp"
#include "tasks/step/step_method.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

class TransitionSearch {
public:
    TransitionSearch(Workspace& workspace, StepMethod& method);

    /// Before a detect cycle: the pulleys' part of the step's result.
    void prepare_detection();
    /// After it: the first fault in the result, and whether a tip may change its phase (due()). Adds to counters.suppressed.
    [[nodiscard]] Fault check(Counters& counters);
    [[nodiscard]] bool due() const noexcept { return due_; }
    /// Slopes of the links at the step's start, which locate and truncate cycles interpolate. Only few steps need them.
    void complete_start_slopes();
    /// Before and after an evaluate cycle at the step's end: the slope there. @return the cycle
    [[nodiscard]] int prepare_end_slope();
    void close_end_slope();
    /// After a locate cycle: takes the earliest transition of all segments as the place of the cut; false if none lies within the step.
    [[nodiscard]] bool locate();
    /// Before a truncate cycle: the pulleys at the cut. @return the cycle
    [[nodiscard]] int prepare_truncation();
    /// After it: the state at the cut is the current one. Reports every tip that has changed to `observer`.
    void truncate(RunObserver& observer, Counters& counters);
    /// Reports every tip that differs from tips.phases_before to `observer`.
    void report_changes(RunObserver& observer, Counters& counters);

private:
    Workspace& w_;
    StepMethod& method_;
    bool due_ = false;
};

}  // namespace cvtflow::tasks
