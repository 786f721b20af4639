/// The classical methods as tables, with their orders and how far they reach (StageReach).

#include "engine/method/stage_plan.hpp"

namespace cvtflow::engine {

namespace {

[[nodiscard]] StagePlan with(int order, int embedded_order, const StageReach& reach, StagePlan plan) {
    plan.order = order;
    plan.embedded_order = embedded_order;
    plan.reach = reach;
    return plan;
}

}  // namespace

StagePlan euler() {
    return with(1, 0, {0.0027320510962454136, 2.0000009999999944, 0.01, 0.020099504987865658},
                butcher_plan("euler", "explicit Euler method", "Euler, Institutionum calculi integralis I (1768) 424-425", {}, {1.0}));
}

StagePlan heun() {
    return with(2, 1, {0.20165889345727012, 2.0000009999994939, 0.21000000000000005, 0.44403569491776596},
                butcher_plan("heun", "explicit trapezoidal rule, error estimate from Euler's method",
                             "Heun, Z. Math. Phys. 45 (1900) 23-38", {{1.0}}, {0.5, 0.5}, {1.0, 0.0}));
}

StagePlan rk4() {
    return with(4, 0, {2.8305411263297375, 2.7852942266743077, 0.44000000000000022, 2.8485704941402696},
                butcher_plan("rk4", "classical Runge-Kutta method", "Kutta, Z. Math. Phys. 46 (1901) 435-453",
                             {{0.5}, {0.0, 0.5}, {0.0, 0.0, 1.0}}, {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0}));
}

namespace {

using Row = std::vector<double>;

std::vector<Row> dopri54_rows() {
    return {
        {1.0 / 5.0},
        {3.0 / 40.0, 9.0 / 40.0},
        {44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0},
        {19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0},
        {9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0},
        {35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0},
    };
}

}  // namespace

/// RK5(4)7M: order 5, embedded order 4; the last stage is the result.
StagePlan dopri54() {
    const Row weights{35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0, 0.0};
    const Row embedded{5179.0 / 57600.0, 0.0, 7571.0 / 16695.0, 393.0 / 640.0, -92097.0 / 339200.0, 187.0 / 2100.0, 1.0 / 40.0};
    return with(5, 4, {1.3810222844872544, 3.3065684369851454, 1.390000000000001, 1.872144513276081},
                butcher_plan("dopri54", "Dormand and Prince 5(4), the last slope is the next first",
                             "Dormand and Prince, J. Comput. Appl. Math. 6 (1980) 19-26", dopri54_rows(), weights, embedded));
}

}  // namespace cvtflow::engine
