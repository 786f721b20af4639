#pragma once
/// A measured spectrum as text, CSV, JSON and pictures.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "bench/lab/plot/plot.hpp"
#include "bench/study/spectrum.hpp"
#include "bench/study/stability/stable_step.hpp"
#include "tasks/method/auto_step.hpp"

namespace cvtflow::bench {

/// A method's largest stable step, predicted and measured.
struct PlanLimit {
    std::string method;
    StableStep predicted;
    MeasuredStep measured;
};

struct SpectrumResult {
    std::string scene, friction;      ///< names
    double time = 0.0;                ///< [s]
    long touching = 0;                ///< tips
    double tight = 0.0, slack = 0.0;  ///< mean tension of the strands [N]
    int unknowns = 0;
    bench::Eigenvalues values;                        ///< all, or those at the edge
    bool complete = true;                             ///< whether these are all
    int dimension = 0;                                ///< dimension of the Krylov space, if not complete
    double residual = 0.0;                            ///< largest relative residual, if not complete
    std::string method;                               ///< method of the scene
    double step = 0.0;                                ///< step of the scene [s]
    std::optional<PlanLimit> limit;                   ///< absent: the method is no table of stages
    std::optional<tasks::LargestStep> program_limit;  ///< stated limit; absent: the method is a table of stages
    std::optional<Attribution> attribution;
    double border = -1e6;  ///< border of the attribution [1/s]
};

[[nodiscard]] std::string spectrum_text(const SpectrumResult& result);
/// One row per eigenvalue: real, imaginary part, shares by kind of contact (empty where not attributed).
[[nodiscard]] std::string spectrum_csv(const SpectrumResult& result);
[[nodiscard]] std::string spectrum_json(const SpectrumResult& result);
/// Eigenvalues in the complex plane, coloured by the contact that causes them. @param scale of both axes: linear or symlog
[[nodiscard]] tools::Plot spectrum_plot(const SpectrumResult& result, tools::Scale scale);
/// Number of eigenvalues that decay faster than a rate, by the contact that causes them: suits extreme eigenvalues, which are nearly all
/// real.
[[nodiscard]] tools::Plot edge_plot(const SpectrumResult& result);
/// Number of eigenvalues that decay faster than a rate, with unchanged and tenfold saturation speeds. Requires an attribution.
[[nodiscard]] tools::Plot slowed_plot(const SpectrumResult& result);

[[nodiscard]] nlohmann::ordered_json limit_json(const PlanLimit& limit);
/// "50.95 ns predicted (…), 50.97 ns measured (+0.04 %)".
[[nodiscard]] std::string limit_text(const PlanLimit& limit);

}  // namespace cvtflow::bench
