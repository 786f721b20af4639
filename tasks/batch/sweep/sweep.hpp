#pragma once
/// A sweep: a scene and a question over many variants of it, read from a TOML file as strictly as a scene is.
///
///     [sweep]
///     scene = "tiny"                     # ready scene, or file relative to this one
///     [set]                              # keys of the scene that all cases share
///     run.until = "0.2 ms"
///     [[axes]]                           # every axis multiplies the number of cases; the last one varies fastest
///     key = "load.torque"
///     values = ["6 N*m", "12 N*m"]       # or: from, to, count, scale = "linear" | "log"
///     [[axes]]                           # keys that vary together
///     zip = [{key = "clamping.driving", values = […]}, {key = "clamping.driven", values = […]}]
///     [[axes]]                           # a sample of a box
///     sample = "latin-hypercube"         # or "random"
///     count = 100
///     seed = 1
///     keys = [{key = "tip.friction_coefficient", from = 0.05, to = 0.12}, …]
///     [[axes]]
///     csv = "rows.csv"                   # first line: keys, with a unit in brackets if the cells have none: load.torque [N*m]
///     [outputs]
///     scalars = ["slip mean", "efficiency mean", "ratio at 0.1 ms", "links/tension[0] max"]
///     from = "0.1 ms"                    # outputs before it do not count
///     records = false                    # one record per case in DIR/records
///     [budget]                           # of one case
///     steps = 100000
///     wall = "10 min"
///     [start]
///     mode = "scene"                     # the scene's own start | "settle": every case settles | "shared": settled once for all cases of
///     one machine continuation = "clamping.driven"   # key of the last axis: a case starts where its neighbour ended check = 2 # so many
///     continued cases also run from their own start; the summary tells the difference. Default 1

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tasks/batch/sweep/axis.hpp"
#include "tasks/batch/sweep/scalar.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {

enum class StartMode { scene, settle, shared };

struct Sweep {
    std::string name;  ///< the file's stem if the sweep does not say
    std::string description;
    std::filesystem::path path;  ///< of the file, as given
    std::string text;            ///< of the file
    Scene scene;                 ///< with [set] and [budget] applied
    std::vector<Axis> axes;
    std::vector<Scalar> scalars;
    double from = 0.0;  ///< outputs before this time do not count [s]
    bool records = false;
    StartMode start = StartMode::scene;
    std::string continuation;  ///< key; empty: none
    int checked = 1;           ///< continued cases that also run from their own start

    [[nodiscard]] long cases() const noexcept;
    /// Number of cases that follow each other by continuation; 1 without it. Cases [k strand, (k + 1) strand) are one strand.
    [[nodiscard]] long strand() const noexcept;
    /// Row of an axis that a case takes.
    [[nodiscard]] std::size_t row(long number, std::size_t axis) const noexcept;
    /// Gives the scene, which must be a copy of this->scene or of another case, the values of a case.
    void apply_case(long number, Scene& scene) const;
    /// Everything that results depend on, one "key = value" per line, for comparison.
    [[nodiscard]] std::string definition() const;
};

/// Reads and checks a sweep and its base scene. @param find_scene where a scene of that name or relative path is
/// @throws SceneError  all problems at once: `sweep.toml:7:1: axes.vlues: unknown key (did you mean "values"?)`
[[nodiscard]] Sweep read_sweep(const std::filesystem::path& path,
                               const std::function<std::filesystem::path(const std::string&)>& find_scene);

/// What is wrong with a case's values taken together; empty if nothing.
[[nodiscard]] std::string violations(const Scene& scene);

}  // namespace cvtflow::tasks
