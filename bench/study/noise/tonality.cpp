#include "bench/study/noise/tonality.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cvtflow::bench {
namespace {

/// Power between two orders, lines spread over one order each.
class BandPowers {
public:
    explicit BandPowers(const OrderPowers& powers) : sums_(powers.size() + 1) {
        std::partial_sum(powers.begin(), powers.end(), sums_.begin() + 1);
    }
    [[nodiscard]] double between(double from, double to) const { return up_to(to) - up_to(from); }

private:
    [[nodiscard]] double up_to(double order) const {
        const double place = std::clamp(order + 0.5, 0.0, static_cast<double>(sums_.size() - 1));
        const auto cell = std::min(static_cast<std::size_t>(place), sums_.size() - 2);
        return sums_[cell] + (place - static_cast<double>(cell)) * (sums_[cell + 1] - sums_[cell]);
    }
    std::vector<double> sums_;
};

/// The other edge of a critical band that ends at `edge` [Hz]. @param side -1 below, 1 above
double other_edge(double edge, double side) {
    double width = critical_bandwidth(edge);
    for (int pass = 0; pass < 6; ++pass) width = critical_bandwidth(std::sqrt(edge * std::max(0.0, edge + side * width)));
    return std::max(0.0, edge + side * width);
}

struct Prominence {
    double middle, neighbours;  ///< power of the band, mean power of its neighbours
};

Prominence prominence(const BandPowers& bands, double frequency, double round) {
    const double width = critical_bandwidth(frequency);
    const double lower = -0.5 * width + std::sqrt(0.25 * width * width + frequency * frequency), upper = lower + width;
    return {bands.between(lower / round, upper / round), 0.5 * (bands.between(other_edge(lower, -1.0) / round, lower / round) +
                                                                bands.between(upper / round, other_edge(upper, 1.0) / round))};
}

std::vector<double> ranks(const std::vector<double>& values) {
    std::vector<double> ranks;
    for (const double value : values) {
        const auto below = std::count_if(values.begin(), values.end(), [=](double v) { return v < value; });
        const auto equal = std::count(values.begin(), values.end(), value);
        ranks.push_back(static_cast<double>(below) + 0.5 * static_cast<double>(equal - 1));
    }
    return ranks;
}

}  // namespace

double critical_bandwidth(double frequency) {
    const double kilohertz = 1e-3 * frequency;
    return 25.0 + 75.0 * std::pow(1.0 + 1.4 * kilohertz * kilohertz, 0.69);
}

double tonality(const OrderPowers& powers, double round, int pins) {
    const BandPowers bands(powers);
    std::vector<Prominence> all;
    double strongest = 0.0;
    for (int order = (pins + 1) / 2; order <= 7 * pins / 2; ++order) {
        all.push_back(prominence(bands, order * round, round));
        strongest = std::max(strongest, all.back().middle);
    }
    if (!(strongest > 0.0)) return 0.0;
    double largest = 0.0;
    for (const Prominence& each : all) {
        if (each.middle < 0.01 * strongest) continue;
        largest = std::max(largest, each.middle / std::max(each.neighbours, background * strongest));
    }
    return 10.0 * std::log10(largest);
}

double rank_correlation(const std::vector<double>& a, const std::vector<double>& b) {
    if (a.size() != b.size() || a.size() < 3) return 0.0;
    const std::vector<double> x = ranks(a), y = ranks(b);
    const double mean = 0.5 * static_cast<double>(a.size() - 1);
    double xx = 0.0, yy = 0.0, xy = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        xx += (x[k] - mean) * (x[k] - mean);
        yy += (y[k] - mean) * (y[k] - mean);
        xy += (x[k] - mean) * (y[k] - mean);
    }
    return xx > 0.0 && yy > 0.0 ? xy / std::sqrt(xx * yy) : 0.0;
}

}  // namespace cvtflow::bench
