#include "tasks/tuning/pareto.hpp"

#include <cmath>

namespace cvtflow::tasks {

std::vector<bool> pareto_front(const std::vector<TradeoffPoint>& points) {
    std::vector<bool> front;
    for (const TradeoffPoint& point : points) {
        bool beaten = !std::isfinite(point.error);
        for (const TradeoffPoint& other : points) {
            const bool no_worse = other.error <= point.error && other.seconds <= point.seconds;
            beaten = beaten || (no_worse && (other.error < point.error || other.seconds < point.seconds));
        }
        front.push_back(!beaten);
    }
    return front;
}

std::optional<std::size_t> recommended(const std::vector<TradeoffPoint>& points, double error, double safety) {
    std::optional<std::size_t> best;
    for (std::size_t k = 0; k < points.size(); ++k) {
        if (!(points[k].error * safety <= error)) continue;
        if (!best || points[k].seconds < points[*best].seconds) best = k;
    }
    return best;
}

}  // namespace cvtflow::tasks
