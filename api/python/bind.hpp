#pragma once
/// The parts of the Python module; each binds what one public header declares. Internal to api/python.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cvtflow/cvtflow.hpp>
#include <memory>
#include <string>
#include <vector>

namespace cvtflow::python {

namespace py = pybind11;

/// The interpreter's lock is given up while this lives: the action must touch nothing of Python's.
using Released = py::gil_scoped_release;

/// How long Python may wait until somebody looks for its signals [s].
inline constexpr double between_looks = 0.05;

/// A Python callable that C++ may copy and drop on any thread, with or without the lock.
using Callable = std::shared_ptr<py::function>;
[[nodiscard]] Callable share(py::function function);

/// An array of numbers that takes over a vector's memory. @param width > 1: [n, width]
[[nodiscard]] py::array_t<double> array_of(std::vector<double> values, std::size_t width = 1);

void bind_errors(py::module_& module);
void bind_scene(py::module_& module);
void bind_values(py::module_& module);
void bind_simulation(py::module_& module);
void bind_records(py::module_& module);

}  // namespace cvtflow::python
