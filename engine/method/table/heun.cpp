#include "engine/method/stage_plan.hpp"

namespace cvtflow::engine {

StagePlan heun() {
    return butcher_plan("heun", "explicit trapezoidal rule, error estimate from Euler's method", "Heun, Z. Math. Phys. 45 (1900) 23-38",
                        {{1.0}}, {0.5, 0.5}, {1.0, 0.0});
}

}  // namespace cvtflow::engine
