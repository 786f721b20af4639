#pragma once
/// Description of a simulation. It is immutable: any number of simulations and threads may share it.

#include <cvtflow/error.hpp>

#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace cvtflow {
inline namespace v0_4 {

/// A handle to a checked scene; copies share it. All members are safe to call from several threads at once.
class Scene {
public:
    /// Reads a scene file. @throws Error (scene): every problem in it, one per line; always in the core library, which reads no files
    [[nodiscard]] static Scene read(const std::string& path) { return made(cvtflow_scene_read, path.c_str()); }
    /// A scene given as text; `name` replaces the file name in messages, and start.state is relative to its folder. @throws Error (scene)
    [[nodiscard]] static Scene parse(const std::string& text, const std::string& name = "scene.toml") {
        return made(cvtflow_scene_parse, text.c_str(), name.c_str());
    }
    /// A scene that comes with cvtflow ("baseline"), from the installed data or the folders of the environment variable CVTFLOW_SCENES. The
    /// core library contains these scenes, without their saved states: they settle. cvtflow_describe("scenes") has all of them.
    /// @throws Error (scene)
    [[nodiscard]] static Scene ready(const std::string& name) { return made(cvtflow_scene_ready, name.c_str()); }

    /// This scene with settings "key=value", as --set on the command line; the problems begin with the setting. @throws Error (scene)
    [[nodiscard]] Scene with(std::span<const std::string> settings) const {
        std::vector<const char*> texts;
        for (const std::string& each : settings) texts.push_back(each.c_str());
        return made(cvtflow_scene_with, get(), texts.data(), texts.size());
    }
    [[nodiscard]] Scene with(const std::string& setting) const { return with(std::span(&setting, 1)); }
    /// with({"a=1", "b=2"}): without this one, two texts in braces would be taken for the begin and the end of one.
    [[nodiscard]] Scene with(std::initializer_list<std::string> settings) const {
        return with(std::span<const std::string>(settings.begin(), settings.size()));
    }
    /// This scene at a level of detail: "rigid", "fine", "full". A state file that then no longer fits is dropped.
    /// @throws Error (scene)
    [[nodiscard]] Scene with_detail(const std::string& preset) const { return made(cvtflow_scene_with_detail, get(), preset.c_str()); }

    [[nodiscard]] std::string name() const { return cvtflow_scene_name(get()); }
    /// The scene as TOML with every key.
    [[nodiscard]] std::string text() const { return detail::text(cvtflow_scene_text, get()); }
    /// Value of a key, as TOML: value("run.step") is "2e-6". @throws Error (argument) for an unknown key
    [[nodiscard]] std::string value(const std::string& key) const { return detail::text(cvtflow_scene_value, get(), key.c_str()); }

    /// The handle of C, which lives as long as a copy of this.
    [[nodiscard]] const cvtflow_scene* get() const noexcept { return handle_.get(); }
    /// Takes over a handle of C.
    explicit Scene(cvtflow_scene* handle) : handle_(handle, cvtflow_scene_release) {}

private:
    template <class Function, class... Arguments>
    [[nodiscard]] static Scene made(Function* function, Arguments... arguments) {
        cvtflow_scene* handle = nullptr;
        detail::call(function, arguments..., &handle);
        return Scene(handle);
    }

    std::shared_ptr<const cvtflow_scene> handle_;
};

/// A quantity with its unit, in SI: quantity("0.1 ms", "s") is 1e-4. @param unit SI unit that is expected, "1" for a plain number
/// @throws Error (argument) for texts that are no number, unknown units and other dimensions
[[nodiscard]] inline double quantity(const std::string& text, const std::string& unit) {
    double value = 0.0;
    detail::call(cvtflow_quantity, text.c_str(), unit.c_str(), &value);
    return value;
}

/// What the library knows of keys, channels, inputs, units, … as JSON (cvtflow_describe). @throws Error (argument)
[[nodiscard]] inline std::string describe(const std::string& what) { return detail::text(cvtflow_describe, what.c_str()); }

}  // namespace v0_4
}  // namespace cvtflow
