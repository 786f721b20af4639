#pragma once
/// The parts of the Python module; each binds what one public header declares. Internal to api/python.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cvtflow/cvtflow.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace cvtflow::python {

namespace py = pybind11;

/// The interpreter's lock is given up while this lives: the action must touch nothing of Python's.
using Released = py::gil_scoped_release;

/// Time between two checks for Python's signals [s].
inline constexpr double between_checks = 0.05;

/// A simulation, and how fast it goes: Python checks for signals after spans of whole output intervals that take about a twentieth of a
/// second. A span that ended between two outputs would begin the means of channels anew.
struct Stepper {
    Simulation simulation;
    Threads threads;
    int segments;
    double interval = quantity(simulation.scene().value("run.output_interval") + " s", "s");  ///< [s]
    double pace = 0.0;  ///< simulated over wall time; 0: not known yet
};

/// A call of a Python function, which takes the lock; C++ may copy and drop it on any thread, with or without the lock.
[[nodiscard]] inline auto locked(py::function function) {
    const std::shared_ptr<py::function> held(new py::function(std::move(function)), [](py::function* owned) {
        const py::gil_scoped_acquire lock;
        delete owned;
    });
    return [held](const auto&... arguments) {
        const py::gil_scoped_acquire lock;
        (*held)(arguments...);
    };
}

/// A number in SI, or a text with a unit: 1e-4 or "0.1 ms".
using Quantity = std::variant<double, std::string>;
/// @param name of the argument, for messages. @throws Error (argument)
[[nodiscard]] double in_si(const Quantity& quantity, const std::string& name, const std::string& unit);

/// A scene, the name of a ready one, or a file.
using SceneLike = std::variant<std::string, std::filesystem::path, Scene>;
/// @throws Error (scene)
[[nodiscard]] Scene scene_of(const SceneLike& given);

/// A function of the package's Python part: by_python("_scene", "keys").
[[nodiscard]] py::object by_python(const char* file, const char* function);

/// An array of numbers that takes over a vector's memory. @param width > 1: [n, width]
[[nodiscard]] py::array_t<double> array_of(std::vector<double> values, std::size_t width = 1);

void bind_errors(py::module_& module);
void bind_scene(py::module_& module);
void bind_simulation(py::module_& module);
void bind_records(py::module_& module);

}  // namespace cvtflow::python
