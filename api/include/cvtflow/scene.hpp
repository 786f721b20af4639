#pragma once
/// Description of a simulation. It is immutable: any number of simulations and threads may share it.

#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <cvtflow/export.hpp>

namespace cvtflow {
inline namespace v0 {

class Recording;
class Simulation;
struct TuneOptions;
struct Tuning;

/// A handle to a checked scene; copies share it. All members are safe to call from several threads at once.
class CVTFLOW_EXPORT Scene {
public:
    /// Reads a scene file. @throws Error (scene): every problem in it, one per line; always in the core library, which reads no files
    [[nodiscard]] static Scene read(const std::string& path);
    /// A scene given as text; `name` replaces the file name in messages, and start.state is relative to its folder. @throws Error (scene)
    [[nodiscard]] static Scene parse(const std::string& text, const std::string& name = "scene.toml");
    /// A scene that comes with cvtflow ("baseline"), from the installed data or the folders of the environment variable CVTFLOW_SCENES. The
    /// core library contains these scenes, without their saved states: they settle. @throws Error (scene)
    [[nodiscard]] static Scene ready(const std::string& name);
    /// Names of the scenes that ready() finds, in alphabetical order; some may be scenes that cannot be read.
    [[nodiscard]] static std::vector<std::string> ready_names();

    /// This scene with settings "key=value", as --set on the command line; the problems begin with the setting. @throws Error (scene)
    [[nodiscard]] Scene with(std::span<const std::string> settings) const;
    [[nodiscard]] Scene with(const std::string& setting) const;
    /// with({"a=1", "b=2"}): without this one, two texts in braces would be taken for the begin and the end of one.
    [[nodiscard]] Scene with(std::initializer_list<std::string> settings) const {
        return with(std::span<const std::string>(settings.begin(), settings.size()));
    }
    /// This scene at a level of detail: "rigid", "fine", "full". A state file that then no longer fits is dropped.
    /// @throws Error (scene)
    [[nodiscard]] Scene with_detail(const std::string& preset) const;

    [[nodiscard]] const std::string& name() const noexcept;
    [[nodiscard]] const std::string& description() const noexcept;
    /// The scene as TOML with every key.
    [[nodiscard]] std::string text() const;
    /// Value of a key, as TOML: value("run.step") is "2e-6". @throws Error (argument) for an unknown key
    [[nodiscard]] std::string value(const std::string& key) const;

private:
    struct Data;
    explicit Scene(std::shared_ptr<const Data> data) noexcept;
    friend class Recording;
    friend class Simulation;
    friend CVTFLOW_EXPORT Tuning tune(const Scene& scene, const TuneOptions& options);

    std::shared_ptr<const Data> data_;
};

/// A key of scenes.
struct KeyInfo {
    std::string name;                  ///< "load.torque"
    std::string unit;                  ///< SI unit, "1" for a plain number; empty where the value is no number
    std::string description;           ///< one or two sentences
    std::string usual;                 ///< default as TOML
    std::string source;                ///< origin of the default
    double min = 0.0;                  ///< smallest value allowed [unit]
    double max = 0.0;                  ///< largest value allowed [unit]
    std::vector<std::string> choices;  ///< allowed names; empty if the value is not a name
    bool table = false;                ///< whether the value may be a table over time
};

/// All keys of scenes, section by section.
[[nodiscard]] CVTFLOW_EXPORT std::vector<KeyInfo> scene_keys();

/// A quantity with its unit, in SI: quantity("0.1 ms", "s") is 1e-4. @param unit SI unit that is expected, "1" for a plain number
/// @throws Error (argument) for texts that are no number, unknown units and other dimensions
[[nodiscard]] CVTFLOW_EXPORT double quantity(const std::string& text, const std::string& unit);

/// The unit in which pictures and tables show a quantity.
struct DisplayUnit {
    std::string unit;     ///< "bar", "rpm", "kN", "%"; the SI unit, if none is more usual
    double factor = 1.0;  ///< factor from the SI unit
};

/// @param name of a channel, a column of a sweep or a key   @param unit its SI unit
[[nodiscard]] CVTFLOW_EXPORT DisplayUnit display_unit(const std::string& name, const std::string& unit);

}  // namespace v0
}  // namespace cvtflow
