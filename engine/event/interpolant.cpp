#include "engine/event/interpolant.hpp"

namespace cvtflow::engine {

void Interpolant::evaluate(double theta, int from, int to, double* out) const noexcept {
    const double* __restrict y0 = start + from;
    const double* __restrict f0 = start_slope + from;
    const double* __restrict y1 = end + from;
    const double* __restrict f1 = end_slope + from;
    double* __restrict y = out;
    const double rest = 1.0 - theta;
    const double bend = -theta * rest;
    const double skew = 1.0 - 2.0 * theta;
    const double weight0 = -rest * h;
    const double weight1 = theta * h;
    for (int i = 0; i < to - from; ++i) {
        y[i] = rest * y0[i] + theta * y1[i] + bend * (skew * (y1[i] - y0[i]) + weight0 * f0[i] + weight1 * f1[i]);
    }
}

}  // namespace cvtflow::engine
