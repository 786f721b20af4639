#include "bench/study/profile/model.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace cvtflow::bench {

using namespace tasks;

double even_speed_up(int links, int threads) noexcept {
    const int longest = (links + threads - 1) / threads;
    return static_cast<double>(links) / longest;
}

double amdahl_speed_up(double serial_share, int threads) noexcept { return 1.0 / (serial_share + (1.0 - serial_share) / threads); }

double meeting(const PathCosts& costs, int threads, MeetingLaw law) noexcept {
    if (threads == 1) return 0.0;
    return law == MeetingLaw::linear ? costs.synchronisation + costs.per_thread * threads
                                     : costs.synchronisation_tree + costs.per_doubling * std::log2(threads);
}

double expected_largest(int count) noexcept {
    if (count < 2) return 0.0;
    const double upper = 1.0 - (count - 0.375) / (count + 0.25);  // share of normal numbers above
    double low = 0.0, high = 10.0;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (0.5 * std::erfc(middle / std::sqrt(2.0)) > upper ? low : high) = middle;
    }
    return low;
}

SegmentCost lanes_of(const Segment& segment, const std::vector<bool>& touching, int lanes) {
    SegmentCost cost;
    for (int first = segment.first; first < segment.last; first += lanes) {
        const auto begin = touching.begin() + first, end = touching.begin() + std::min(first + lanes, segment.last);
        (std::find(begin, end, true) == end ? cost.free : cost.touching) += lanes;
    }
    return cost;
}

double step_time(const PathCosts& costs, const Partition& partition, int threads, const std::vector<bool>& touching, double meeting) {
    const int segments = partition.size(), links = static_cast<int>(touching.size());
    const bool alone = threads == 1 && segments == 1;
    double evaluation = 0.0, detection = 0.0;
    for (int thread = 0, first = 0; thread < threads; ++thread) {
        const int last = first + segments / threads + (thread < segments % threads);  // as executors share
        double time = 0.0;
        int own = 0;
        for (int s = first; s < last; ++s) {
            time += alone ? 0.0 : costs.border;
            own += partition[s].size();
            const SegmentCost cost = lanes_of(partition[s], touching, costs.lanes);
            time += costs.free * cost.free + costs.touching * cost.touching;
        }
        evaluation = std::max(evaluation, time);
        detection = std::max(detection, costs.detect * own);
        first = last;
    }
    const double late = costs.jitter * std::sqrt(static_cast<double>(links) / threads) * expected_largest(threads);
    const double stretch = threads == 1 ? 1.0 : costs.stretch, between = costs.controller + (threads == 1 ? 0.0 : meeting);
    return costs.evaluations * (stretch * evaluation + late + between) + stretch * detection + between + costs.other_cycles * between;
}

double predicted_speed_up(const PathCosts& costs, int threads, const std::vector<bool>& touching, MeetingLaw law) {
    const int links = static_cast<int>(touching.size());
    return step_time(costs, Partition::equal(links, 1), 1, touching, 0.0) /
           step_time(costs, Partition::equal(links, threads, Partition::grain(costs.lanes)), threads, touching,
                     meeting(costs, threads, law));
}

void fit_links(std::span<const SegmentCost> samples, PathCosts& costs) {
    const auto total = [&](auto part) {
        double sum = 0.0;
        for (const SegmentCost& sample : samples) sum += part(sample);
        return sum;
    };
    const bool distinct =
        total([](const SegmentCost& s) { return s.free; }) > 0.0 && total([](const SegmentCost& s) { return s.touching; }) > 0.0;
    Eigen::MatrixXd counts(static_cast<Eigen::Index>(samples.size()), distinct ? 3 : 2);
    Eigen::VectorXd times(static_cast<Eigen::Index>(samples.size()));
    for (Eigen::Index row = 0; row < times.size(); ++row) {
        const SegmentCost& sample = samples[static_cast<std::size_t>(row)];
        counts(row, 0) = 1.0;
        counts(row, 1) = distinct ? sample.free : sample.free + sample.touching;
        if (distinct) counts(row, 2) = sample.touching;
        times(row) = sample.seconds;
    }
    Eigen::VectorXd fit = counts.completeOrthogonalDecomposition().solve(times);
    if (fit(0) < 0.0) {  // no border costs less than nothing: once more without
        fit(0) = 0.0;
        fit.tail(fit.size() - 1) = counts.rightCols(fit.size() - 1).completeOrthogonalDecomposition().solve(times);
    }
    costs.border = fit(0);
    costs.free = fit(1);
    costs.touching = distinct ? fit(2) : fit(1);
}

namespace {

/// times ≈ fixed + growth x of(threads), neither below zero.
void fit_law(std::span<const ThreadCost> samples, double (*of)(double), double& fixed, double& growth) {
    Eigen::MatrixXd counts(static_cast<Eigen::Index>(samples.size()), 2);
    Eigen::VectorXd times(static_cast<Eigen::Index>(samples.size()));
    for (Eigen::Index row = 0; row < times.size(); ++row) {
        counts.row(row) << 1.0, of(samples[static_cast<std::size_t>(row)].threads);
        times(row) = samples[static_cast<std::size_t>(row)].seconds;
    }
    if (samples.size() < 2) {
        fixed = samples.empty() ? 0.0 : samples[0].seconds;
        growth = 0.0;
        return;
    }
    const Eigen::VectorXd fit = counts.completeOrthogonalDecomposition().solve(times);
    growth = std::max(0.0, fit(1));
    fixed = std::max(0.0, fit(0));
}

}  // namespace

void fit_synchronisation(std::span<const ThreadCost> samples, PathCosts& costs) {
    fit_law(
        samples, [](double threads) { return threads; }, costs.synchronisation, costs.per_thread);
    fit_law(
        samples, [](double threads) { return std::log2(threads); }, costs.synchronisation_tree, costs.per_doubling);
}

std::vector<SpeedUpRow> speed_up_curves(const PathCosts& costs, double serial_share, const std::vector<bool>& touching, int measured,
                                        int most) {
    const int links = static_cast<int>(touching.size());
    const double serial = step_time(costs, Partition::equal(links, 1), 1, touching, 0.0);
    PathCosts punctual = costs;
    punctual.jitter = 0.0;
    std::vector<SpeedUpRow> rows;
    for (int threads = 1; threads <= std::min(most, links); ++threads) {
        const double farther =
            meeting(costs, threads, MeetingLaw::linear) + (far - 1.0) * costs.per_thread * std::max(0, threads - std::max(1, measured));
        rows.push_back(
            {threads, static_cast<double>(threads), even_speed_up(links, threads), amdahl_speed_up(serial_share, threads),
             predicted_speed_up(costs, threads, touching),
             serial / step_time(costs, Partition::equal(links, threads, Partition::grain(costs.lanes)), threads, touching, farther),
             predicted_speed_up(punctual, threads, touching, MeetingLaw::logarithmic)});
    }
    return rows;
}

}  // namespace cvtflow::bench
