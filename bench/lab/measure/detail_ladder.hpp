#pragma once
/// The levels of detail at operating points that tell them apart, each with its own automatic step, against the finest level at a quarter
/// of its step.

#include <string>
#include <vector>

#include "bench/lab/measure/detail_measure.hpp"

namespace cvtflow::bench {

/// Where levels are compared: a scene and what is changed there.
struct LadderPoint {
    std::string name, scene;
    std::vector<std::string> settings;  ///< key=value
    bool controlled = true;             ///< whether the thrust ratio is looked for
};

/// The scenes asked for. None asked for: all that a ladder is judged by, from ratios over loads to a shift and a ramp of the load; the
/// ramp lasts as long as the averaging.
[[nodiscard]] std::vector<LadderPoint> ladder_points(const DetailArguments& arguments);

/// A level of detail as a variant. share: of its automatic step [1]
[[nodiscard]] DetailVariant rung_variant(const tasks::DetailPreset& preset, double share);

struct DetailLevelResult {
    DetailOutcome outcome;
    double seconds = 0.0;  ///< processor time per simulated second, median of rounds of 2 ms, all rungs in turns [s/s]
    double spread = 0.0;   ///< of the rounds, over their median [1]
};

struct Ladder {
    LadderPoint point;
    DetailOutcome reference;               ///< the finest level at a quarter of its step
    std::vector<DetailLevelResult> rungs;  ///< finest first
};

/// @throws tasks::SceneError; tasks::SimulationError where the reference breaks down or is unreliable
[[nodiscard]] Ladder measure_ladder(const DetailArguments& arguments, const LadderPoint& point);

}  // namespace cvtflow::bench
