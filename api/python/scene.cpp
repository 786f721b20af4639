#include "api/python/bind.hpp"

#include <chrono>
#include <functional>

namespace cvtflow::python {

namespace {

[[nodiscard]] Scene with_settings(const Scene& scene, const py::args& settings) {
    return scene.with(settings.cast<std::vector<std::string>>());
}

/// Whether a signal has come that raised an exception; looks now and then, from where Python's lock is not held.
class SignalWatch {
public:
    [[nodiscard]] bool operator()() noexcept {
        const auto now = std::chrono::steady_clock::now();
        if (raised_ || std::chrono::duration<double>(now - looked_).count() < between_looks) return raised_;
        looked_ = now;
        const py::gil_scoped_acquire lock;
        raised_ = PyErr_CheckSignals() != 0;
        return raised_;
    }
    [[nodiscard]] bool raised() const noexcept { return raised_; }

private:
    std::chrono::steady_clock::time_point looked_ = std::chrono::steady_clock::now();
    bool raised_ = false;
};

[[nodiscard]] Tuning tuned(const Scene& scene, double accuracy, std::vector<std::string> outputs, double budget, std::string folder) {
    SignalWatch watch;
    TuneOptions options{accuracy, std::move(outputs), budget, std::move(folder)};
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
    py::class_<Tuning>(module, "Tuning", "A scene as it should be run for an accuracy.")
        .def_readonly("scene", &Tuning::scene, "The scene with the detail, method and step that were chosen.")
        .def_readonly("choice", &Tuning::choice, "What was chosen, in words.")
        .def_readonly("error", &Tuning::error, "Largest error that was measured.")
        .def_readonly("kept", &Tuning::kept, "Whether it had been found before.");
    module.def(
        "tune", &tuned, py::arg("scene"), py::arg("accuracy") = 0.01, py::arg("outputs") = std::vector<std::string>{},
        py::arg("budget") = 0.0, py::arg("folder") = "",
        "The cheapest detail, method and step with which outputs (slip, efficiency, tight_tension, tips) are as accurate: measured, or "
        "as found before. Takes seconds to minutes. A signal ends it as it ends advance_to().");
}

}  // namespace

void bind_scene(py::module_& module) {
    py::class_<Scene> scene(module, "Scene", "What is simulated: an immutable description, read and checked as a whole.");
    scene.def_static("read", &Scene::read, py::arg("path"), "Reads a scene file. Raises SceneError with every problem in it.")
        .def_static("parse", &Scene::parse, py::arg("text"), py::arg("name") = "scene.toml",
                    "A scene given as TOML; name stands for the file in messages, start.state is relative to its folder.")
        .def_static("ready", &Scene::ready, py::arg("name"), "A scene that comes with cvtflow, e.g. \"baseline\".")
        .def("with_", &with_settings,
             "This scene with settings \"key=value\", values with their units: scene.with_(\"run.step=1 us\", \"load.torque=8 N*m\").")
        .def("with_detail", &Scene::with_detail, py::arg("preset"), "This scene at a level of detail: coarse, medium, fine, full.")
        .def("value", &Scene::value, py::arg("key"), "Value of a key, as TOML.")
        .def_property_readonly("name", &Scene::name, "Name of the scene.")
        .def_property_readonly("description", &Scene::description, "What it is, one line.")
        .def_property_readonly("text", &Scene::text, "The scene as TOML with every key.")
        .def("__repr__", [](const Scene& scene) { return "<cvtflow.Scene " + scene.name() + ">"; })
        .def("__eq__", [](const Scene& one, const Scene& other) { return one.text() == other.text(); })
        .def(py::pickle([](const Scene& scene) { return py::make_tuple(scene.text()); },
                        [](const py::tuple& kept) { return Scene::parse(kept[0].cast<std::string>()); }));
    bind_tune(module);
}

}  // namespace cvtflow::python
