#pragma once
/// Compares the levels of detail at several operating points, each at its automatic step, with the finest level at a quarter of its step.

#include <string>
#include <vector>

#include "bench/lab/measure/detail_measure.hpp"

namespace cvtflow::bench {

/// An operating point: a scene and its changes.
struct LadderPoint {
    std::string name, scene;
    std::vector<std::string> settings;  ///< key=value
    bool controlled = true;             ///< whether ratio control finds the thrust ratio
};

/// The requested scenes; without a request the seven standard operating points. The ramp of the load lasts as long as the averaging.
[[nodiscard]] std::vector<LadderPoint> ladder_points(const DetailArguments& arguments);

/// A level of detail as a variant. share: of its automatic step [1]
[[nodiscard]] DetailVariant level_variant(const tasks::DetailPreset& preset, double share);

struct DetailLevelResult {
    DetailOutcome outcome;
    double seconds = 0.0;  ///< processor time per simulated second, median of rounds of 2 ms, all levels in turns [s/s]
    double spread = 0.0;   ///< of the rounds, over their median [1]
};

struct Ladder {
    LadderPoint point;
    DetailOutcome reference;                ///< the finest level at a quarter of its step
    std::vector<DetailLevelResult> levels;  ///< finest first
};

/// @throws tasks::SceneError; tasks::SimulationError if the reference fails or is unreliable
[[nodiscard]] Ladder measure_ladder(const DetailArguments& arguments, const LadderPoint& point);

}  // namespace cvtflow::bench
