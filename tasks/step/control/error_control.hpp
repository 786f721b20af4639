#pragma once
/// Local errors of steps: estimated, reported, and where they decide, turned into the length of the next step.

#include <vector>

#include "tasks/step/control/step_settings.hpp"
#include "tasks/step/step_method.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

class ErrorControl {
public:
    /// @throws std::invalid_argument if errors are requested and the method estimates none
    ErrorControl(Workspace& workspace, const StepMethod& method, const StepSettings& settings);

    /// Whether the error decides the length of steps.
    [[nodiscard]] bool decides() const noexcept { return decides_; }
    /// Before a detect cycle: which row estimates the error.
    void prepare(const StepMethod& method) const;
    /// After it: whether the step is accurate enough. A step that is retaken up to a transition always is.
    [[nodiscard]] bool accepts(bool retaken);
    /// Proposed length of the next step [s].
    [[nodiscard]] double proposal() const noexcept { return size_.proposal(); }
    [[nodiscard]] const LocalErrorStatistics& statistics() const noexcept { return statistics_; }

    /// Where the error decides, what is remembered goes before (comes from) the front of a method's memory.
    void save(std::vector<double>& memory) const;
    void load(std::span<const double>& memory);

private:
    [[nodiscard]] double step_error() const;

    Workspace& w_;
    bool estimates_, decides_;
    double tolerance_;  ///< in units of ErrorScale
    StepSizeControl size_;
    LocalErrorStatistics statistics_;
};

}  // namespace cvtflow::tasks
