#pragma once
/// A scene: everything that a run is made from, read from a TOML file. Every key, its unit, range, default and meaning is a row of
/// tasks/scene/parameter_table.cpp; this file is what programs use.
///
/// A scene is checked completely before anything runs. SceneError carries all problems at once, one per line:
///
///     scene.toml:14:9: chain.pitch: 8.12 m is outside [1e-3, 5e-2] m (did you mean "8.12 mm"?)

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "engine/record/run/state_file.hpp"
#include "model/machine/vehicle.hpp"
#include "model/parameters/parameters.hpp"
#include "tasks/step/assembly/assembly_kind.hpp"
#include "tasks/step/control/step_control.hpp"

namespace cvtflow::tasks {

/// A scene's state, read once: simulations made from one scene, at once or one after the other, share it. Any thread.
class KeptState {
public:
    KeptState();

    /// The state in a file: as it was read, until the file is another one (by its identity, size and time of change). A file that has gone
    /// since is the one that was read.
    /// @throws engine::RecordError, std::bad_alloc
    [[nodiscard]] std::shared_ptr<const engine::SavedState> read(const std::string& path) const;

private:
    struct Kept;
    std::shared_ptr<Kept> kept_;
};

/// A positive number, or a word such as "auto" (Parameter::choices): the program chooses it.
struct AutoNumber {
    double value = 0.0;  ///< 0: automatic [unit of the key]

    constexpr AutoNumber() = default;
    /// number [unit of the key]
    constexpr AutoNumber(double number) noexcept : value(number) {}
    constexpr operator double() const noexcept { return value; }
    [[nodiscard]] constexpr bool automatic() const noexcept { return value == 0.0; }
    /// other [the same]
    [[nodiscard]] constexpr double value_or(double other) const noexcept { return automatic() ? other : value; }
    bool operator==(const AutoNumber&) const = default;
};

/// Settings of the integration and of the record.
struct RunSettings {
    std::string method = "auto";  ///< name in the catalogue of methods, or auto: see method_of()
    AutoNumber step;              ///< fixed or longest [s]; automatic: as long as the method is stable and accurate at the present state
    StepControl step_control = StepControl::fixed;
    double tolerance = 1.0;         ///< limit of local errors, in units of ErrorScale [1]
    AutoNumber until = 5e-3;        ///< [s]; automatic: once the means are steady
    double steady = 0.01;           ///< largest error of means then (SteadyRule) [1]
    double steady_limit = 16.0;     ///< latest end of such a run [revolutions of the chain]
    double output_interval = 5e-5;  ///< channels [s]
    double state_interval = 2e-4;   ///< full states [s]
    long max_steps = 0;             ///< 0: no limit
    double max_wall = 0.0;          ///< wall-clock limit, 0: none [s]
    int followed_pin = 0;           ///< pin whose channels are recorded
    std::string schedule = "auto";  ///< executor by name in the catalogue, or auto: the fastest by trials during the run
    Assembly assembly = Assembly::fused;
    PartitionKind partition = PartitionKind::equal;
    int segments = 0;                   ///< parts of the chain that are separate tasks; 0: as many as threads
    int threads = 0;                    ///< 0: as many as this process may use
    std::uint64_t seed = 0;             ///< seed of all that is drawn by chance
    std::vector<std::string> channels;  ///< recorded beside the usual ones: names, or groups such as "tips/*"
    bool means = false;                 ///< an output is the mean since the one before, and not of its instant

    /// Outputs from one at which a step ends to the next: those of automatic steps that are closer than 50 us lie between, unless whole
    /// states are recorded there.
    [[nodiscard]] long outputs_together() const noexcept {
        constexpr double apart = 50e-6;
        const bool between = step.automatic() && step_control == StepControl::fixed && state_interval >= apart;
        return between ? static_cast<long>(std::ceil(apart / output_interval * (1.0 - 1e-12))) : 1;
    }
    bool operator==(const RunSettings&) const = default;
};

/// Gains of ratio control: control.proportional and control.integral as given, or found from the machine, clamping force and speed.
enum class ControlGains { given, found };

/// Keeper of the ratio in a run that ends when it is steady: control, or after a while the driving sheave, which is held.
enum class WhenSteady { control, hold };

/// detail.level: the keys of [detail] as they are given, or 1 + number of a level in detail_presets().
enum class DetailLevel { given };

struct Scene {
    std::string name;  ///< the file's stem if absent
    std::string description;
    model::Parameters parameters;
    RunSettings run;
    model::Vehicle vehicle;  ///< load, drive and control of `parameters` follow from it and the cycle (derive)
    model::Cycle cycle;
    ControlGains gains = ControlGains::given;
    WhenSteady when_steady = WhenSteady::control;
    DetailLevel level = DetailLevel::given;  ///< `given` except while detail.level is read: then its keys are set, and state it (level_of)
    std::string state_file;                  ///< absolute path of the state to start from; empty: geometric start
    std::string state_place;                 ///< place of start.state, for problems that show later: `scene.toml:12:9: `; empty: nowhere
    std::string method_place;                ///< the same of run.method
    KeptState start_state;                   ///< state that state_file holds, read once
    std::string text;                        ///< the TOML as it was read; not changed by set_values or apply_detail (see write_scene)
    std::filesystem::path path;              ///< path of the file, as given
    std::vector<std::filesystem::path> named_files;  ///< files that its values name: CSV tables, and states whether they are used or not
    std::array<bool, 2> floors{};                    ///< whether it gives clamping.driven, hydraulics.driven_pressure (see note_floor)
};

/// The file that a scene was read from and those that it names: nothing written for it may replace them. Empty paths: none.
[[nodiscard]] std::vector<std::filesystem::path> input_files(const Scene& scene);

/// A scene that cannot be used. what() is the full message: one problem per line, in the order of their positions.
class SceneError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Use of start.state: `ignored` reads a scene whose state file is not there (yet), as one with a geometric start. `recorded` does the same
/// for the scene in a record, state or checkpoint, and refuses one that names a CSV file: the content of a file must not determine which
/// other file is read.
enum class StartState { required, ignored, recorded };

/// The text of a TOML file. @throws SceneError "path: cannot be read: why"
[[nodiscard]] std::string read_toml_text(const std::filesystem::path& path);

/// Reads and checks a scene file.
/// @throws SceneError  unreadable file, or any problem in it
[[nodiscard]] Scene read_scene(const std::filesystem::path& path, StartState start = StartState::required);

/// Checks a scene given as text. `name` replaces the file name in messages, and start.state is relative to its folder.
/// @throws SceneError
[[nodiscard]] Scene parse_scene(std::string text, std::filesystem::path name, StartState start = StartState::required);

/// Applies settings "key=value" in their order, then checks the whole scene; so settings that are consistent only together can be given
/// together. A value is written as in TOML; quotes around texts, choices and quantities may be left out (shells strip them). start.state is
/// relative to the working directory, as everything on a command line is. The scene is unchanged if anything is wrong.
/// @param origin  text before a setting in messages; hosts have no command line and pass "": long settings are then shortened
/// @throws SceneError  lines begin with `--set key=value: `
void set_values(Scene& scene, std::span<const std::string> settings, std::string_view origin = "--set ");

/// set_values with one setting.
void set_value(Scene& scene, std::string_view setting);

/// Keys that determine the layout or meaning of the state vector. A state file is valid for one value of each.
[[nodiscard]] std::span<const std::string_view> state_keys() noexcept;

/// A level of detail: a name for some of the dials of [detail]. Cost and error were measured at seven operating points (docs/accuracy.md).
/// Errors are typical: half of the points have smaller ones.
struct DetailPreset {
    std::string_view name;
    std::string_view meaning;
    model::PinDetail pins;
    model::PlateDetail plates;
    int joint_points;
    model::PulleyDetail pulleys;
    double cost;           ///< processor time of a simulated second over that of "fine", each with its automatic step [1]
    double tension_error;  ///< error of the strands' tensions, the larger one, against the finest level at a quarter of its step [1]
    double slip_error;     ///< error of the slip, likewise [1]
};

/// All levels of detail, coarsest first.
[[nodiscard]] std::span<const DetailPreset> detail_presets() noexcept;

/// Keys that a level of detail sets.
[[nodiscard]] std::span<const std::string_view> dial_keys() noexcept;

/// The level whose keys the scene has; empty: none.
[[nodiscard]] std::string_view level_of(const Scene& scene) noexcept;

/// Sets the dials of a preset. Keeps the friction law, its smoothing and stick_slip, and pulleys = "absent".
/// @throws SceneError  unknown preset
void apply_detail(Scene& scene, std::string_view preset);

/// The method that a simulation of the scene takes: a name of the catalogue (tasks/method/method.hpp).
[[nodiscard]] std::string method_of(const Scene& scene);

/// Latest end of the run [s]; for a run that ends once it is steady, an estimate by speed and ratio at t = 0.
[[nodiscard]] double latest_end(const Scene& scene);

/// The scene as TOML with every key: what a run used, whatever file, presets and settings it came from. parse_scene reads it back equal.
[[nodiscard]] std::string write_scene(const Scene& scene);

}  // namespace cvtflow::tasks
