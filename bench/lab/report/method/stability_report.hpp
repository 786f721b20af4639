#pragma once
/// Stability of methods as text, CSV, JSON and pictures: of those that are programs, and regions of those that are tables of stages.

#include <optional>
#include <string>
#include <vector>

#include "bench/lab/plot/plot.hpp"
#include "bench/lab/report/method/spectrum_report.hpp"
#include "bench/method/stability/program_stability.hpp"
#include "bench/method/stability/step_limit.hpp"
#include "bench/study/stability/stable_step.hpp"
#include "tasks/method/method.hpp"

namespace cvtflow::bench {

/// A method's largest stable step on a scene, predicted and measured.
struct ProgramLimit {
    std::string method;
    bench::StepLimit predicted;
    MeasuredLimit measured;
};
/// "1.91 us (oscillation …) predicted, 1.91 us measured (+0.1 %)".
[[nodiscard]] std::string limit_text(const ProgramLimit& limit);

/// Reaches are infinite beyond bench::far_away.
struct ProgramResult {
    tasks::MethodProgram program;
    bench::ProgramStability stability;
    double first = 0.0, second = 0.0;  ///< oscillator: h ω without friction, h c at rest; linear: reach along the real, the imaginary axis
    bench::FrictionLimit any{};        ///< oscillator only: for every friction
    double ray_1 = 0.0, ray_5 = 0.0;   ///< linear only: along rays of damping ratio 1 % and 5 %
    bench::StageFigures worst;         ///< figures over all decays that the method takes
    std::optional<ProgramLimit> limit;  ///< limit on a scene
    double step = 0.0;                  ///< step of the scene's point on the map; 0: the longest stable one [s]

    [[nodiscard]] bool oscillator() const noexcept { return stability.equation == bench::TestEquation::oscillator; }
};

/// @param program with a stability function
[[nodiscard]] ProgramResult program_result(const tasks::MethodProgram& program);

/// Lines for one method.
[[nodiscard]] std::string program_figures(const ProgramResult& result);
/// A line for each method with a limit.
[[nodiscard]] std::string limit_lines(const std::vector<ProgramResult>& results);
/// One table for each test equation.
[[nodiscard]] std::string program_table(const std::vector<ProgramResult>& results);
[[nodiscard]] std::string program_csv(const std::vector<ProgramResult>& results);
/// One method; null: without limit.
/// Region of stability: over (h ω, h c) or the complex plane of h λ; with a limit, also the oscillation
/// that sets it at the result's step.
[[nodiscard]] tools::Plot program_map(const ProgramResult& result);

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
/// One method; the parts that need a scene only with one.
/// |R(z)| ≤ 1, and the eigenvalues times the step. @param values may be empty   @param step [s]
[[nodiscard]] tools::Plot stability_map(const StabilityResult& result, const bench::Eigenvalues& values, double step,
                                        const std::string& scene);

}  // namespace cvtflow::bench
