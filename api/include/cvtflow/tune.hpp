#pragma once
/// The cheapest detail, method and step for a target accuracy, found by measuring, as in `cvtflow run --accuracy`.

#include <cvtflow/error.hpp>
#include <cvtflow/scene.hpp>

#include <functional>
#include <string>
#include <vector>

namespace cvtflow {
inline namespace v0_4 {

struct TuneOptions {
    double accuracy = 0.01;  ///< largest error of the outputs, above 0 and at most 0.5 [1]
    /// Outputs whose error counts: "slip", "efficiency", … or as in a sweep, "slip median"; none: slip, efficiency, tight_tension, tips.
    std::vector<std::string> outputs;
    double budget = 0.0;  ///< wall time after which no further choice is tried; 0: no limit [s]
    std::string folder;   ///< cache of choices; empty: $XDG_CACHE_HOME/cvtflow or ~/.cache/cvtflow
    /// Asked every 50 ms, by the calling thread: true ends the measuring. May be empty; must not throw.
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
[[nodiscard]] inline Tuning tune(const Scene& scene, const TuneOptions& options) {
    std::string outputs;
    for (const std::string& name : options.outputs) outputs += (outputs.empty() ? "" : ",") + name;
    const cvtflow_asked_function asked = [](void* stop) { return (*static_cast<const std::function<bool()>*>(stop))() ? 1 : 0; };
    cvtflow_scene* tuned = nullptr;
    cvtflow_tuning found{};
    found.size = sizeof found;
    detail::call(cvtflow_tune, scene.get(), options.accuracy, outputs.empty() ? nullptr : outputs.c_str(), options.budget,
                 options.folder.c_str(), options.stop ? asked : nullptr, const_cast<void*>(static_cast<const void*>(&options.stop)), &tuned,
                 &found);
    return {Scene(tuned), found.choice, found.error, found.kept != 0};
}

}  // namespace v0_4
}  // namespace cvtflow
