#include "bench/method/product_names.hpp"
#include "engine/method/stage_plan.hpp"

namespace cvtflow::bench {

StagePlan rk38() {
    return butcher_plan("rk38", "Kutta's 3/8 rule: a little more accurate than rk4, as stable", "Kutta, Z. Math. Phys. 46 (1901) 435-453",
                        {{1.0 / 3.0}, {-1.0 / 3.0, 1.0}, {1.0, -1.0, 1.0}}, {0.125, 0.375, 0.375, 0.125});
}

}  // namespace cvtflow::bench
