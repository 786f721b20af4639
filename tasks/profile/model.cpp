#include "tasks/profile/model.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace cvtflow::tasks {

double even_speed_up(int links, int threads) noexcept {
    const int longest = (links + threads - 1) / threads;
    return static_cast<double>(links) / longest;
}

double amdahl_speed_up(double serial_share, int threads) noexcept { return 1.0 / (serial_share + (1.0 - serial_share) / threads); }

double step_time(const PathCosts& costs, const Partition& partition, const std::vector<bool>& touching) {
    double evaluation = 0.0, detection = 0.0;
    for (const Segment& segment : partition.segments()) {
        double time = costs.border;
        for (int link = segment.first; link < segment.last; ++link) time += touching[static_cast<std::size_t>(link)] ? costs.touching : costs.free;
        evaluation = std::max(evaluation, time);
        detection = std::max(detection, costs.detect * segment.size());
    }
    const double meeting = partition.size() == 1 ? 0.0 : costs.synchronisation + costs.per_thread * partition.size();
    return costs.evaluations * (evaluation + costs.controller + meeting) + detection + costs.controller + meeting;
}

double predicted_speed_up(const PathCosts& costs, int threads, const std::vector<bool>& touching) {
    const int links = static_cast<int>(touching.size());
    return step_time(costs, Partition::equal(links, 1), touching) / step_time(costs, Partition::equal(links, threads), touching);
}

void fit_links(std::span<const SegmentCost> samples, PathCosts& costs) {
    const auto total = [&](auto part) {
        double sum = 0.0;
        for (const SegmentCost& sample : samples) sum += part(sample);
        return sum;
    };
    const bool distinct = total([](const SegmentCost& s) { return s.free; }) > 0.0 && total([](const SegmentCost& s) { return s.touching; }) > 0.0;
    Eigen::MatrixXd counts(static_cast<Eigen::Index>(samples.size()), distinct ? 3 : 2);
    Eigen::VectorXd times(static_cast<Eigen::Index>(samples.size()));
    for (Eigen::Index row = 0; row < times.size(); ++row) {
        const SegmentCost& sample = samples[static_cast<std::size_t>(row)];
        counts(row, 0) = 1.0;
        counts(row, 1) = distinct ? sample.free : sample.free + sample.touching;
        if (distinct) counts(row, 2) = sample.touching;
        times(row) = sample.seconds;
    }
    const Eigen::VectorXd fit = counts.completeOrthogonalDecomposition().solve(times);
    costs.border = std::max(0.0, fit(0));
    costs.free = fit(1);
    costs.touching = distinct ? fit(2) : fit(1);
}

void fit_synchronisation(std::span<const ThreadCost> samples, PathCosts& costs) {
    Eigen::MatrixXd counts(static_cast<Eigen::Index>(samples.size()), 2);
    Eigen::VectorXd times(static_cast<Eigen::Index>(samples.size()));
    for (Eigen::Index row = 0; row < times.size(); ++row) {
        counts.row(row) << 1.0, samples[static_cast<std::size_t>(row)].threads;
        times(row) = samples[static_cast<std::size_t>(row)].seconds;
    }
    if (samples.size() < 2) {
        costs.synchronisation = samples.empty() ? 0.0 : samples[0].seconds;
        costs.per_thread = 0.0;
        return;
    }
    const Eigen::VectorXd fit = counts.completeOrthogonalDecomposition().solve(times);
    costs.synchronisation = std::max(0.0, fit(0));
    costs.per_thread = std::max(0.0, fit(1));
}

std::vector<SpeedUpRow> speed_up_curves(const PathCosts& costs, double serial_share, const std::vector<bool>& touching, int most) {
    const int links = static_cast<int>(touching.size());
    std::vector<SpeedUpRow> rows;
    for (int threads = 1; threads <= std::min(most, links); ++threads) {
        rows.push_back({threads, static_cast<double>(threads), even_speed_up(links, threads), amdahl_speed_up(serial_share, threads),
                        predicted_speed_up(costs, threads, touching)});
    }
    return rows;
}

}  // namespace cvtflow::tasks
