/// The Python module cvtflow._cvtflow: the public C++ interface, name by name.

#include "api/python/bind.hpp"

namespace cvtflow::python {

double in_si(const Quantity& quantity, const std::string& name, const std::string& unit) {
    if (const auto* number = std::get_if<double>(&quantity)) return *number;
    try {
        return cvtflow::quantity(std::get<std::string>(quantity), unit);
    } catch (const Error& error) {
        throw Error(error.code(), name + ": " + error.what());
    }
}

py::object by_python(const char* file, const char* function) {
    return py::module_::import((std::string("cvtflow.") + file).c_str()).attr(function);
}

py::array_t<double> array_of(std::vector<double> values, std::size_t width) {
    auto* kept = new std::vector<double>(std::move(values));
    const py::capsule owner(kept, [](void* memory) { delete static_cast<std::vector<double>*>(memory); });
    const auto rows = static_cast<py::ssize_t>(width == 0 ? 0 : kept->size() / width);
    const py::array::ShapeContainer flat{rows}, square{rows, static_cast<py::ssize_t>(width)};
    return py::array_t<double>(width == 1 ? flat : square, kept->data(), owner);
}

/// An object that __new__ made and no __init__ has nothing behind it: pybind11 would take uninitialised memory for its value.
void refuse_objects_without_init(const py::module_& module) {
    const py::handle metaclass(reinterpret_cast<PyObject*>(py::detail::get_internals().default_metaclass));
    for (const auto& [name, object] : module.attr("__dict__").cast<py::dict>()) {
        if (!py::isinstance(object, metaclass)) continue;
        py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(object.ptr()))->operator_new = [](std::size_t) -> void* {
            throw py::type_error("this object was made by __new__() without __init__()");
        };
    }
}

}  // namespace cvtflow::python

PYBIND11_MODULE(_cvtflow, module) {
    using namespace cvtflow::python;
    module.doc() = "The C++ interface of cvtflow. Import cvtflow instead, which adds a Python interface.";
    bind_errors(module);
    bind_scene(module);
    bind_simulation(module);
    bind_records(module);
    module.def(
        "quantity", &cvtflow::quantity, pybind11::arg("text"), pybind11::arg("unit"),
        "A quantity with its unit, in SI: quantity(\"0.1 ms\", \"s\") is 1e-4. unit: SI unit that is expected, \"1\" for a plain number.");
    module.def(
        "display_unit",
        [](const std::string& name, const std::string& unit) {
            const cvtflow::DisplayUnit how = cvtflow::display_unit(name, unit);
            return std::make_pair(how.unit, how.factor);
        },
        pybind11::arg("name"), pybind11::arg("unit"),
        "The unit in which pictures and tables show a channel, a column or a key, and the factor from its SI unit: "
        "display_unit(\"shaft_1/speed\", \"rad/s\") is (\"rpm\", 9.549…).");
    module.def("_sums_of_quotient", &cvtflow::sums_of_quotient, pybind11::arg("channel"),
               "Channels of which the mean of a quotient is made, in sums.");
    module.def("library_version", &cvtflow::library_version, "Version of the loaded library.");
    module.def("shutdown", &cvtflow::shutdown, pybind11::call_guard<Released>(),
               "Ends the worker threads of all simulations of this process. False if other users keep them alive.");
    refuse_objects_without_init(module);
}
