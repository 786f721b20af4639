#pragma once
/// The cheapest detail, method and step for a target accuracy, found by measuring, as in `cvtflow run --accuracy`.

#include <functional>
#include <string>
#include <vector>

#include <cvtflow/export.hpp>
#include <cvtflow/scene.hpp>

namespace cvtflow {
inline namespace v0 {

struct TuneOptions {
    double accuracy = 0.01;  ///< largest error of the outputs, above 0 and at most 0.5 [1]
    /// Outputs whose error counts: "slip", "efficiency", … or as in a sweep, "slip median"; none: slip, efficiency, tight_tension, tips.
    std::vector<std::string> outputs;
    double budget = 0.0;                                 ///< wall time after which no further choice is tried; 0: no limit [s]
    std::string folder;                                  ///< cache of choices; empty: $XDG_CACHE_HOME/cvtflow or ~/.cache/cvtflow
    std::function<void(const std::string&)> progress{};  ///< receives what is being measured; may be empty
    /// Asked after every step, by the calling thread: true ends the measuring. May be empty; must not throw.
    std::function<bool()> stop{};
};

struct Tuning {
    Scene scene;         ///< scene with the choice, from the start of the given one
    std::string choice;  ///< choice in words: "fine, leapfrog-sweep, automatic step"
    double error = 0.0;  ///< largest measured error
    bool kept = false;   ///< taken from the cache, not measured now
};

/// Measures at the scene's start and at the extremes of its tables over time, or takes the choice from the cache. Serial, in the calling
/// thread; takes seconds to minutes.
/// @throws Error (argument) accuracy; (scene) outputs that there are not; (start_state); (state) nothing is as accurate, or nothing can be
/// measured: what() names the closest; (cancelled) options.stop returned true; nothing is cached
[[nodiscard]] CVTFLOW_EXPORT Tuning tune(const Scene& scene, const TuneOptions& options);

}  // namespace v0
}  // namespace cvtflow
