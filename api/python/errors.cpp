/// An exception class per code, made from the codes' names: non_finite becomes NonFiniteError.

#include <cctype>
#include <map>
#include <utility>

#include "api/python/bind.hpp"

namespace cvtflow::python {

namespace {

constexpr int last_code = 99;
constexpr int first_fault = static_cast<int>(ErrorCode::non_finite);

/// Exception classes by code; they live as long as the interpreter.
std::map<int, PyObject*>& classes() {
    static std::map<int, PyObject*> rows;
    return rows;
}

[[nodiscard]] std::string class_name(const std::string& code_name) {
    if (code_name == "memory") return "OutOfMemoryError";  // Python has a MemoryError, of which this is one
    std::string name;
    bool upper = true;
    for (const char letter : code_name) {
        if (letter != '_') name += upper ? static_cast<char>(std::toupper(letter)) : letter;
        upper = letter == '_';
    }
    return name + "Error";
}

[[nodiscard]] PyObject* new_class(py::module_& module, const std::string& name, const std::string& doc, const py::handle& bases) {
    const std::string full = "cvtflow." + name;
    PyObject* made = PyErr_NewExceptionWithDoc(full.c_str(), doc.c_str(), bases.ptr(), nullptr);
    if (made == nullptr) throw py::error_already_set();
    module.attr(name.c_str()) = py::reinterpret_borrow<py::object>(made);
    return made;
}

void raise(const Error& error) {
    const auto found = classes().find(static_cast<int>(error.code()));
    const py::handle type(found != classes().end() ? found->second : classes().at(0));
    py::object made = type(error.what());
    made.attr("code") = error_name(error.code());
    PyErr_SetObject(type.ptr(), made.ptr());
}

}  // namespace

void bind_errors(py::module_& module) {
    const py::handle base(PyExc_RuntimeError);
    classes()[0] = new_class(module, "Error", "Base of all errors; `code` identifies the kind.", base);
    const py::handle error(classes().at(0));
    const py::handle fault(
        new_class(module, "Fault", "The simulation cannot continue; its state is that of the last accepted step.", error));
    const py::handle value(PyExc_ValueError), memory(PyExc_MemoryError);
    for (int code = 1; code <= last_code; ++code) {
        const std::string name = error_name(static_cast<ErrorCode>(code));
        if (name == "unknown") continue;
        auto bases = py::reinterpret_borrow<py::object>(code >= first_fault ? fault : error);
        if (code == static_cast<int>(ErrorCode::argument) || code == static_cast<int>(ErrorCode::scene))
            bases = py::make_tuple(error, value);
        if (code == static_cast<int>(ErrorCode::memory)) bases = py::make_tuple(error, memory);
        classes()[code] = new_class(module, class_name(name), "The error \"" + name + "\" of the C++ interface (error.hpp).", bases);
    }
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            std::rethrow_exception(std::move(thrown));
        } catch (const Error& error_thrown) {
            raise(error_thrown);
        }
    });
}

}  // namespace cvtflow::python
