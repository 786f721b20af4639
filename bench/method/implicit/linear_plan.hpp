#pragma once
/// Linearly implicit one-step methods (W-methods, Rosenbrock methods) as tables. Stage i solves one linear system,
///
///     (I - γ h J) u_i = γ (h f(t + c h, y + Σ a u_j) + Σ c u_j),      y⁺ = y + Σ m u_i,
///
/// with any J: a W-method keeps its order. The time of a stage is derived as if J did not depend on time.
/// Slots of the table are numbers of stages.

#include <string>
#include <vector>

#include "bench/method/product_names.hpp"
#include "engine/method/stage_plan.hpp"

namespace cvtflow::bench {

struct LinearStage {
    double gamma;                      ///< θ/h of its matrix [1]
    std::vector<engine::Term> states;  ///< a: increments in the stage's state
    std::vector<engine::Term> right;   ///< c: increments on the right-hand side
};

struct LinearPlan {
    std::string name, description, source;
    int order;  ///< order for any J
    std::vector<LinearStage> stages;
    std::vector<engine::Term> result;  ///< m
};

/// Times of the stages [h], derived; and Σ m τ, which is 1 for a consistent method.
struct LinearTimes {
    std::vector<double> stage;  ///< [1]
    double result;              ///< [1]
};
[[nodiscard]] LinearTimes times_of(const LinearPlan& plan);

/// Steihaug and Wolfbrandt's method of two stages, order 2. (Math. Comp. 33, 1979)
[[nodiscard]] LinearPlan steihaug_wolfbrandt();
/// ROS34PW2, four stages, order 3. (Rang and Angermann, BIT 45, 2005)
[[nodiscard]] LinearPlan ros34pw2();
/// Linearly implicit Euler steps, 1 … order of them over the step, extrapolated. @param order 1 … 4
[[nodiscard]] LinearPlan extrapolated_w(int order);

/// All linear plans; each has a row in the implementation.
[[nodiscard]] const std::vector<LinearPlan>& linear_plans();

}  // namespace cvtflow::bench
