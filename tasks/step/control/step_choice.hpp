#pragma once
/// Chooses the length of automatic steps; implemented by AutoStep.

#include <span>
#include <vector>

#include "model/variator/chain_model.hpp"

namespace cvtflow::tasks {

class StepChoice {
public:
    /// Longest time between two questions [s].
    static constexpr double ask_interval = 125e-6;

    virtual ~StepChoice() = default;
    /// Longest step that is ever chosen [s]: the step grid starts from it.
    [[nodiscard]] virtual double longest() const noexcept = 0;
    /// Longest step at a state [s]. @param time [s] @param state [layout.size()] @param phases [4 links]
    [[nodiscard]] virtual double longest(double time, const double* state, const model::Phase* phases) noexcept = 0;
    /// A new integration begins.
    virtual void restart() noexcept = 0;
    /// For checkpoints: continues bitwise.
    virtual void save(std::vector<double>& memory) const = 0;
    virtual void load(std::span<const double> memory) = 0;  ///< memory [what save() wrote]

protected:
    StepChoice() = default;
    StepChoice(const StepChoice&) = default;
    StepChoice& operator=(const StepChoice&) = default;
};

}  // namespace cvtflow::tasks
