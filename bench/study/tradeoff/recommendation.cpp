#include "bench/study/tradeoff/recommendation.hpp"

namespace cvtflow::bench {

std::optional<std::size_t> recommended(const std::vector<tasks::TradeoffPoint>& points, double error, double safety) {
    std::optional<std::size_t> best;
    for (std::size_t k = 0; k < points.size(); ++k) {
        if (!(points[k].error * safety <= error)) continue;
        if (!best || points[k].seconds < points[*best].seconds) best = k;
    }
    return best;
}

}  // namespace cvtflow::bench
