#pragma once
/// Cost and results of many levels of detail, at one operating point and at several.
///
/// Every variant starts from the scene's settled state at full detail, converted to its coordinates, settles for a short time and is then
/// averaged. The remaining drift is reported: smaller differences are not due to detail.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bench/study/run_watch.hpp"
#include "engine/record/run/state_file.hpp"
#include "model/parameters/parameters.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::bench {

struct DetailArguments {
    std::vector<std::string> scenes;
    std::vector<std::string> settings;
    std::string method = tasks::RunSettings{}.method, step = "auto", settle = "20 ms", average = "20 ms";
    std::string control = "100 ms";  ///< time of ratio control to find the thrust ratio; begins with 0: no search
    bool all = false, levels = false;
};

/// A combination of the dials.
struct DetailVariant {
    model::PlateDetail plates;
    int joint_points;
    model::PulleyDetail pulleys;
    model::PinDetail pins = model::PinDetail::halves;
    std::string_view preset{};  ///< name of the level of detail; empty: none
    double share = 1.0;         ///< share of the automatic step; 1: automatic steps
    double mass_scaling = 1.0;  ///< [1]
    [[nodiscard]] std::string name() const;
};
inline constexpr DetailVariant full_detail{model::PlateDetail::each, 8, model::PulleyDetail::elastic};

/// Full detail first, then one key changed at a time, then several; or every combination.
[[nodiscard]] std::vector<DetailVariant> detail_variants(bool all);

struct DetailOutcome {
    DetailVariant variant = full_detail;
    int coordinates = 0;
    double cost = 0.0;                ///< time of one evaluation of the right-hand side [s]
    double step = 0.0;                ///< last step [s]
    double tight = 0.0, slack = 0.0;  ///< [N]
    double tip = 0.0;                 ///< largest axial force of an end of a pin, both halves together, mean over time [N]
    double slip = 0.0, efficiency = 0.0;
    double ratio = 0.0;                             ///< mean speed ratio
    double shift = 0.0;                             ///< relative rate of the ratio at the scene's clamping [1/s]
    double thrust = 0.0;                            ///< S_1/S_2 that holds the target ratio under load; 0: not determined
    double drift = 0.0;                             ///< difference of the tight strand's tension between both halves of the averaging
    WatchResult watch;                              ///< means over the averaging; balance error of the settling included
    std::string status = "finished";                ///< "finished", "unreliable" or the fault's name
    std::string fault;                              ///< message for that; if not empty, the figures above are invalid
    std::shared_ptr<tasks::Simulation> simulation;  ///< simulation at the end of the averaging
};

/// Measures variants of one scene.
class DetailMeasure {
public:
    /// @throws tasks::SceneError if the scene has no settled state of full detail
    DetailMeasure(DetailArguments arguments, std::string scene);
    /// @param target ratio that ratio control holds; 0: that of the variant itself
    [[nodiscard]] DetailOutcome measure(const DetailVariant& variant, double target) const;

private:
    void find_thrust(const DetailVariant& variant, double target, DetailOutcome& outcome) const;

    DetailArguments arguments_;
    std::string scene_;
    engine::SavedState settled_;
    model::Parameters reference_;
};

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
    double spread = 0.0;   ///< spread of the rounds over their median
};

/// Compares the levels of detail at an operating point, each at its automatic step, with the finest level at a quarter of its step.
struct Ladder {
    LadderPoint point;
    DetailOutcome reference;                ///< the finest level at a quarter of its step
    std::vector<DetailLevelResult> levels;  ///< finest first
};

/// @throws tasks::SceneError; tasks::SimulationError if the reference fails or is unreliable
[[nodiscard]] Ladder measure_ladder(const DetailArguments& arguments, const LadderPoint& point);

}  // namespace cvtflow::bench
