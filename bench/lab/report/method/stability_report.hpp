#pragma once
/// Stability of tables of stages as text, CSV and pictures of their regions.

#include <optional>
#include <string>
#include <vector>

#include "bench/lab/plot/plot.hpp"
#include "bench/lab/report/method/spectrum_report.hpp"
#include "bench/study/stability/stable_step.hpp"

namespace cvtflow::bench {

/// A method and its limits by a scene's spectrum.
struct StabilityResult {
    engine::StagePlan plan;
    double real = 0.0, imaginary = 0.0;  ///< reach along the axes
    double ray_1 = 0.0, ray_5 = 0.0;     ///< reach along rays of damping ratio 1 % and 5 %
    std::optional<PlanLimit> limit;      ///< limit on a scene, if any
    double growth = 0.0, gain = 0.0;     ///< growth of stages and of their errors over the scene's decays at the limit; only with a scene
};

/// Reaches, and over [-length, 0] nothing yet.
[[nodiscard]] StabilityResult stability_of(const engine::StagePlan& plan);

[[nodiscard]] std::string stability_table(const std::vector<StabilityResult>& results);
[[nodiscard]] std::string stability_csv(const std::vector<StabilityResult>& results);
/// |R(z)| ≤ 1, and the eigenvalues times the step. @param values may be empty   @param step [s]
[[nodiscard]] tools::Plot stability_map(const StabilityResult& result, const bench::Eigenvalues& values, double step,
                                        const std::string& scene);

}  // namespace cvtflow::bench
