#pragma once
/// Where a choice has to be right: a scene as it begins, the extremes of its tables over time, corners of a sweep, points in between.

#include <cstdint>
#include <string>
#include <vector>

#include "tasks/batch/sweep/sweep.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {

struct OperatingPoint {
    std::string name;                ///< "start", "load.torque = 230", "case 17"
    Scene scene;                     ///< with its inputs, at its own detail
    double from = 0.0, until = 0.0;  ///< outputs count from there to there [s]
    bool settles = false;            ///< every choice settles from its own geometric start; else all begin with the same state
};

/// How long a point is run: what a change of detail stirs up dies down before outputs count.
struct PointTimes {
    double settle = 20e-3;   ///< [s]
    double average = 16e-3;  ///< [s]
};

/// The scene with its inputs as they are at t = 0, then each table over time at its lowest and highest value, the others as at t = 0.
[[nodiscard]] std::vector<OperatingPoint> points_of(const Scene& scene, const PointTimes& times);

/// Points that lie between those: every table over time somewhere between its lowest and highest value; load and clamping, where they
/// are constant, within 5 % of what they are; of a ring the speed. The same for the same seed.
[[nodiscard]] std::vector<OperatingPoint> unseen_points(const Scene& scene, const PointTimes& times, int count, std::uint64_t seed);

/// A case of a sweep, as it is run there.
[[nodiscard]] OperatingPoint point_of_case(const Sweep& sweep, long number);

/// Cases at the corners of a sweep's axes: all combinations of the rows in which a key is lowest, highest, first or last. Of more than
/// `most` of them so many, evenly picked, first and last included. Cases whose values contradict each other are left out.
[[nodiscard]] std::vector<long> corner_cases(const Sweep& sweep, std::size_t most = 8);

}  // namespace cvtflow::tasks
