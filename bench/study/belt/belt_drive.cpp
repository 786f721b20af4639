#include "bench/study/belt/belt_drive.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cvtflow::bench {

std::array<double, 2> belt_radii(const model::Parameters& p, double ratio) {
    const double centres = p.pulley.centre_distance, target = model::chain_length(p.chain);
    const auto length = [&](double r) {
        const double incline = std::asin(r * (ratio - 1.0) / centres);
        return 2.0 * centres * std::cos(incline) + std::numbers::pi * r * (ratio + 1.0) + 2.0 * incline * r * (ratio - 1.0);
    };
    double low = 0.0, high = 0.999 * centres / std::max(1.0, std::abs(ratio - 1.0));
    for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (low + high);
        (length(middle) < target ? low : high) = middle;
    }
    return {low, ratio * low};
}

double belt_torque_limit(const model::Parameters& p, const BeltPoint& point) {
    return 2.0 * p.tip.friction.coefficient * point.clamping * belt_radii(p, point.ratio)[1] / std::cos(p.tip.angle);
}

BeltDrive solve_belt(const model::Parameters& p, const BeltPoint& point, const BeltParts& parts) {
    const auto [driving, driven] = belt_radii(p, point.ratio);
    const double incline = std::asin((driven - driving) / p.pulley.centre_distance);
    const double wrap_1 = std::numbers::pi - 2.0 * incline, wrap_2 = std::numbers::pi + 2.0 * incline;
    const BeltPulley first{driving, wrap_1, point.speed, point.growth};
    const BeltPulley second{driven, wrap_2, point.speed / point.ratio, -point.growth * wrap_1 / wrap_2};  // the belt keeps its length
    const double difference = point.torque / driven;
    const BeltArc second_arc = BeltArcSolver(p, second, parts).clamped(point.clamping, difference);
    const double slack = second_arc.nodes.front().tension, tight = slack + difference;
    const BeltArc first_arc = BeltArcSolver(p, first, parts).between(tight, slack);
    const double slip = 1.0 - first_arc.friction_speed / first.speed * second.speed / second_arc.friction_speed;
    const double shift = second.growth / second.radius - first.growth / first.radius;
    return {{first, second}, {first_arc, second_arc}, tight, slack, first_arc.clamping / point.clamping, slip, shift};
}

}  // namespace cvtflow::bench
