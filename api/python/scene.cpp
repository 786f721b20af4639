#include "api/python/bind.hpp"

#include <chrono>
#include <functional>

namespace cvtflow::python {

Scene scene_of(const SceneLike& given) {
    if (const auto* scene = std::get_if<Scene>(&given)) return *scene;
    if (const auto* path = std::get_if<std::filesystem::path>(&given)) return Scene::read(path->string());
    const auto& name = std::get<std::string>(given);
    return name.find('/') != std::string::npos || name.ends_with(".toml") ? Scene::read(name) : Scene::ready(name);
}

namespace {

[[nodiscard]] Scene with_settings(const Scene& scene, const py::args& settings, const py::kwargs& values) {
    return scene.with(by_python("_scene", "settings_of")(scene, settings, values).cast<std::vector<std::string>>());
}

[[nodiscard]] Scene create(const std::optional<std::variant<py::dict, std::string, std::filesystem::path>>& given, const py::kwargs& more) {
    if (!given) return with_settings(Scene::parse(""), py::tuple(), more);
    if (const auto* values = std::get_if<py::dict>(&*given)) return with_settings(Scene::parse(""), py::make_tuple(*values), more);
    const auto* name = std::get_if<std::string>(&*given);
    return with_settings(scene_of(name != nullptr ? SceneLike(*name) : SceneLike(std::get<std::filesystem::path>(*given))), py::tuple(),
                         more);
}

/// Whether a signal has raised an exception; checked at intervals, without holding Python's lock.
class SignalWatch {
public:
    [[nodiscard]] bool operator()() noexcept {
        const auto now = std::chrono::steady_clock::now();
        if (raised_ || std::chrono::duration<double>(now - checked_).count() < between_checks) return raised_;
        checked_ = now;
        const py::gil_scoped_acquire lock;
        raised_ = PyErr_CheckSignals() != 0;
        return raised_;
    }
    [[nodiscard]] bool raised() const noexcept { return raised_; }

private:
    std::chrono::steady_clock::time_point checked_ = std::chrono::steady_clock::now();
    bool raised_ = false;
};

[[nodiscard]] Tuning tuned(const SceneLike& given, const Quantity& accuracy, std::vector<std::string> outputs, const Quantity& budget,
                           std::string folder) {
    const Scene scene = scene_of(given);
    SignalWatch watch;
    TuneOptions options{in_si(accuracy, "accuracy", "1"), std::move(outputs), in_si(budget, "budget", "s"), std::move(folder)};
    options.stop = std::ref(watch);
    try {
        const Released released;
        return tune(scene, options);
    } catch (const Error&) {
        if (watch.raised()) throw py::error_already_set();
        throw;
    }
}

void bind_tune(py::module_& module) {
    py::class_<Tuning>(module, "Tuning", "A scene with the settings for a target accuracy.")
        .def_readonly("scene", &Tuning::scene, "The scene with the detail, method and step that were chosen.")
        .def_readonly("choice", &Tuning::choice, "The choice as text.")
        .def_readonly("error", &Tuning::error, "Largest measured error.")
        .def_readonly("kept", &Tuning::kept, "Whether the choice came from the cache.");
    module.def("tune", &tuned, py::arg("scene"), py::arg("accuracy") = 0.01, py::arg("outputs") = std::vector<std::string>{},
               py::arg("budget") = 0.0, py::arg("folder") = "",
               "The cheapest detail, method and step with which outputs (slip, efficiency, tight_tension, tips) are as accurate (\"1 %\"): "
               "measured, or taken from the cache. Takes seconds to minutes. Ctrl-C ends it.");
}

/// The text, with a floor that the scene does not give (a comment there) as if it did: scenes are equal if all keys have equal values.
[[nodiscard]] py::str values_of(const Scene& scene) { return py::str(scene.text()).attr("replace")("\n# ", "\n"); }

void bind_keys(py::module_& module) {
    py::class_<KeyInfo>(module, "KeyInfo", "A key of scenes.")
        .def_readonly("name", &KeyInfo::name, "e.g. load.torque")
        .def_readonly("unit", &KeyInfo::unit, "SI unit; 1 for a plain number, empty if the value is not a number")
        .def_readonly("help", &KeyInfo::description, "meaning")
        .def_property_readonly(
            "range",
            [](const KeyInfo& key) { return key.unit.empty() ? py::object(py::none()) : py::object(py::make_tuple(key.min, key.max)); },
            "smallest and largest allowed value, in the unit; None if the value is not a number")
        .def_property_readonly(
            "default", [](const KeyInfo& key) { return by_python("_scene", "value_of")(key.usual); }, "default value")
        .def_readonly("source", &KeyInfo::source, "source of the default")
        .def_readonly("choices", &KeyInfo::choices, "allowed names; empty if the value is not a name")
        .def_readonly("table", &KeyInfo::table, "whether the value may be a table over time");
    module.def("scene_keys", &scene_keys, "All keys of scenes, section by section.");
}

}  // namespace

void bind_scene(py::module_& module) {
    bind_keys(module);
    py::class_<Scene> scene(module, "Scene", "What is simulated: an immutable description, read and checked as a whole.");
    scene
        .def(py::init(&create), py::arg("values") = py::none(), py::pos_only(),
             "A scene of its own: Scene({\"chain\": {\"pins\": 24}, \"load.torque\": \"8 N*m\"}, run__until=\"1 ms\"), as for with_(). "
             "All other keys have their defaults. A path (\"my.toml\") or the name of a ready scene reads that one.")
        .def_static(
            "read", [](const std::filesystem::path& path) { return Scene::read(path.string()); }, py::arg("path"),
            "Reads a scene file. Raises SceneError with every problem in it.")
        .def_static("parse", &Scene::parse, py::arg("text"), py::arg("name") = "scene.toml",
                    "A scene given as TOML; name replaces the file name in messages, start.state is relative to its folder.")
        .def_static("ready", &Scene::ready, py::arg("name"), "A scene that comes with cvtflow, e.g. \"baseline\".")
        .def_static("ready_names", &Scene::ready_names, "Names of the scenes that ready() finds.")
        .def(
            "with_", &with_settings,
            "This scene with other values: with_({\"load\": {\"torque\": \"8 N*m\"}}), with_({\"load.torque\": 8}), with_(load__torque=8), "
            "with_(until=\"1 ms\") if the last part is unique, or with_(\"load.torque=8 N*m\") as --set of the program. Numbers are in SI, "
            "texts carry their units; a table over time is an array [points, (time, value)].")
        .def("with_detail", &Scene::with_detail, py::arg("preset"), "This scene at a level of detail: rigid, fine, full.")
        .def_static(
            "keys", [](const std::string& part) { return by_python("_scene", "Keys")(part); }, py::arg("part") = "",
            "KeyInfo of all keys by name, or of those whose name contains `part`.")
        .def(
            "__getitem__", [](const Scene& self, const std::string& key) { return by_python("_scene", "item")(self, key); }, py::arg("key"),
            "Value of a key: a number in SI, a text, a truth value, a list, or an array [points, (time, value)].")
        .def("__iter__", [](const Scene&) { return py::iter(by_python("_scene", "Keys")("")); })
        .def("value", &Scene::value, py::arg("key"), "Value of a key, as TOML.")
        .def_property_readonly("name", &Scene::name, "Name of the scene.")
        .def_property_readonly("description", &Scene::description, "Description, one line.")
        .def_property_readonly("text", &Scene::text, "The scene as TOML with every key.")
        .def("__eq__", [](const Scene& one, const Scene& other) { return values_of(one).equal(values_of(other)); })
        .def("__hash__", [](const Scene& self) { return py::hash(values_of(self)); })
        .def(py::pickle([](const Scene& scene) { return py::make_tuple(scene.text()); },
                        [](const py::tuple& kept) { return Scene::parse(kept[0].cast<std::string>()); }));
    bind_tune(module);
}

}  // namespace cvtflow::python
