#include "engine/method/stage_plan.hpp"

namespace cvtflow::engine {

StagePlan rk4() {
    return butcher_plan("rk4", "classical Runge-Kutta method", "Kutta, Z. Math. Phys. 46 (1901) 435-453",
                        {{0.5}, {0.0, 0.5}, {0.0, 0.0, 1.0}}, {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0});
}

}  // namespace cvtflow::engine
