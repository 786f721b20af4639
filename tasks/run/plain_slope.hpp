#pragma once
/// The right-hand side as solvers outside know it: a function of time and unknowns alone.

#include <vector>

#include "model/law/phase_rule.hpp"
#include "model/variator/variator.hpp"

namespace cvtflow::tasks {

/// Serial; owns the memory of one evaluation.
class PlainSlope {
public:
    /// Both must outlive this.
    PlainSlope(const model::Variator& variator, const model::PhaseRule& rule);

    /// out = dx/dt. Phases are those of the moment: a tip that penetrates touches, any other is free; no hysteresis. The contact law is
    /// continuous at depth zero, so out is continuous in x. @param x, out [layout.size()], not the same
    void operator()(double t, const double* x, double* out) noexcept;

private:
    const model::Variator& variator_;
    const model::PhaseRule& rule_;
    model::EvaluationScratch scratch_;
    std::vector<model::Phase> phases_;  ///< [4 links]
};

}  // namespace cvtflow::tasks
