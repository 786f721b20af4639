/// RK6(5)8M of Prince and Dormand: order 6, embedded order 5.

#include "bench/method/product_names.hpp"
#include "engine/method/stage_plan.hpp"

namespace cvtflow::bench {

namespace {

using Row = std::vector<double>;

std::vector<Row> dopri65_rows() {
    return {
        {1.0 / 10.0},
        {-2.0 / 81.0, 20.0 / 81.0},
        {615.0 / 1372.0, -270.0 / 343.0, 1053.0 / 1372.0},
        {3243.0 / 5500.0, -54.0 / 55.0, 50949.0 / 71500.0, 4998.0 / 17875.0},
        {-26492.0 / 37125.0, 72.0 / 55.0, 2808.0 / 23375.0, -24206.0 / 37125.0, 338.0 / 459.0},
        {5561.0 / 2376.0, -35.0 / 11.0, -24117.0 / 31603.0, 899983.0 / 200772.0, -5225.0 / 1836.0, 3925.0 / 4056.0},
        {465467.0 / 266112.0, -2945.0 / 1232.0, -5610201.0 / 14158144.0, 10513573.0 / 3212352.0, -424325.0 / 205632.0, 376225.0 / 454272.0,
         0.0},
    };
}

}  // namespace

StagePlan dopri65() {
    const Row weights{61.0 / 864.0,   0.0,       98415.0 / 321776.0, 16807.0 / 146016.0, 1375.0 / 7344.0, 1375.0 / 5408.0,
                      -37.0 / 1120.0, 1.0 / 10.0};
    const Row embedded{821.0 / 10800.0, 0.0, 19683.0 / 71825.0, 175273.0 / 912600.0, 395.0 / 3672.0, 785.0 / 2704.0, 3.0 / 50.0, 0.0};
    return butcher_plan("dopri65", "Prince and Dormand 6(5), eight stages", "Prince and Dormand, J. Comput. Appl. Math. 7 (1981) 67-75",
                        dopri65_rows(), weights, embedded);
}

}  // namespace cvtflow::bench
