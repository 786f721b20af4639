#pragma once
/// A sweep: a scene and a question over many variants of it, read from a TOML file as strictly as a scene is.
/// Its keys: sweep_keys.hpp; all of them in an example: docs/sweeps.md.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tasks/batch/sweep/axis.hpp"
#include "tasks/batch/sweep/scalar.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {

enum class StartMode { scene, settle, shared };

/// Outputs and accuracy of a sweep.
struct SweepAccuracy {
    double target = 0.0;     ///< largest error of every scalar; 0: nothing is tuned or verified [1]
    int verify = 10;         ///< cases that also run at reference quality, drawn by chance
    std::uint64_t seed = 0;  ///< seed of that draw
};

/// Some cases that end when they are steady also run three times as long.
struct SweepConfirmation {
    int cases = 5;           ///< drawn by chance
    std::uint64_t seed = 0;  ///< seed of that draw
};

struct Sweep {
    std::string name;  ///< the file's stem if absent
    std::string description;
    std::filesystem::path path;  ///< path of the file, as given
    std::string text;            ///< contents of the file
    Scene scene;                 ///< base scene, [set] and [budget] applied
    std::vector<Axis> axes;
    std::vector<Scalar> scalars;
    double from = 0.0;  ///< outputs before this time do not count [s]
    bool records = false;
    StartMode start = StartMode::scene;
    std::string continuation;  ///< key; empty: none
    long line = 1;             ///< cases of a line with continuation: rows of the last axis, or of a csv axis rows while the key rises
    std::string across;        ///< key along which lines follow each other; empty: none
    long lines = 1;            ///< lines of a strand: rows of the axis before the last, or lines of a csv axis while that key rises
    int checked = 1;           ///< continued cases that are repeated without continuation
    SweepAccuracy accuracy;
    SweepConfirmation confirmation;

    /// Whether cases end when they are steady.
    [[nodiscard]] bool steady() const noexcept { return scene.run.until.automatic(); }
    [[nodiscard]] long cases() const noexcept;
    /// Number of cases that start from each other; 1 without continuation. Cases [k strand, (k + 1) strand) are one strand.
    [[nodiscard]] long strand() const noexcept { return continuation.empty() ? 1 : line * lines; }
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

/// Some of the cases [0, cases), drawn by chance; ascending.
[[nodiscard]] std::vector<long> draw_cases(long cases, long count, std::uint64_t seed);

/// Contradictions between a case's values; empty: none.
[[nodiscard]] std::string violations(const Scene& scene);

/// The scene of a case by itself: without a state where the case settles. @throws as saved_start
[[nodiscard]] Scene scene_of_case(const Sweep& sweep, long number);

}  // namespace cvtflow::tasks
