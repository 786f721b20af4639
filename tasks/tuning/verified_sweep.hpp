#pragma once
/// Verified sweeps: tuned at the corners of their axes before they run; then some cases run again at reference
/// quality.

#include <functional>
#include <string>
#include <vector>

#include "tasks/tuning/tuned_scene.hpp"

namespace cvtflow::tasks {

struct TunedSweep {
    Sweep sweep;  ///< sweep with the tuned choice
    KeptTuning kept;
    std::optional<TuneResult> result;  ///< result of a search; nothing: the choice was kept from before
};

/// The sweep with the detail, method and step that its accuracy needs at its corners: as kept in its folder, else measured and kept there.
/// A sweep that asks for no accuracy as it is. Every machine finds the same.
/// @param progress may be empty   @throws AccuracyError, as Tuner; engine::RecordError
[[nodiscard]] TunedSweep tuned_sweep(const Sweep& sweep, const std::string& folder, const engine::Cancellation& cancel,
                                     const std::function<void(const std::string&)>& progress);

/// Cases that are verified: SweepAccuracy::verify of them, drawn by its seed. Ascending.
[[nodiscard]] std::vector<long> cases_to_verify(const Sweep& sweep);

/// Runs cases of a finished sweep again at reference quality and writes errors into their rows (columns `error_of_...`) and into its
/// facts. Rows that have errors keep them. A reference settles, too, where cases do.
/// @param sweep as its file has it, not tuned   @param folder of the results   @return what could not be verified, and why
/// @throws engine::RecordError; SimulationError: interrupted
std::vector<std::string> verify_sweep(const Sweep& sweep, const TunedSweep& tuned, const std::string& folder,
                                      const engine::Cancellation& cancel, const std::function<void(const std::string&)>& progress);

/// Verified errors of a sweep.
struct SweepVerification {
    double target = 0.0;               ///< 0: none
    std::vector<std::string> scalars;  ///< columns
    std::vector<double> worst;         ///< error of each [1]
    long verified = 0, missed = 0;     ///< cases; missed: with an error above the target

    /// One case in twenty may miss it.
    [[nodiscard]] bool held() const noexcept { return 20 * missed <= verified; }
    /// "10 cases verified, 1 beyond 1 %; at most: slip_mean 0.3 %, ratio_mean 0.02 %"
    [[nodiscard]] std::string text() const;
};
/// @throws engine::RecordError
[[nodiscard]] SweepVerification sweep_verification(const std::string& folder);

}  // namespace cvtflow::tasks
