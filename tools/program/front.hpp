#pragma once
/// Commands that Python carries out: this process becomes the interpreter, so signals, terminal and exit status are the command's own.

#include <span>
#include <string>
#include <vector>

namespace cvtflow::tools {

/// Replaces this process by the Python package of this installation or build folder: `python3 -I -B -X utf8 PACKAGE/__main__.py WORDS`.
///
/// The interpreter is CVTFLOW_PYTHON, an absolute path, else the one that CMake found. It runs isolated and with few variables of the
/// environment: nothing in the working folder, PYTHONPATH or the user's packages has an effect. CVTFLOW_PROGRAM names this program to it.
/// @param words  command and arguments   @param script  file of the package
/// @throws UsageError, std::runtime_error: what to install where package or interpreter is missing
[[noreturn]] void become_python(std::span<const std::string> words, const std::string& script = "__main__.py");

/// How a command of Python is started.
struct PythonStart {
    std::vector<std::string> words, environment;  ///< the interpreter first
    /// "NAME requires Python, and … cannot be started: REASON". @param reason errno
    [[nodiscard]] std::string failure(int reason) const;
};
/// @throws UsageError for a relative CVTFLOW_PYTHON; std::runtime_error for a package that is not there, or that others may change
[[nodiscard]] PythonStart python_start(std::span<const std::string> words, const std::string& script = "__main__.py");
/// Texts as a list that ends with nullptr.
[[nodiscard]] std::vector<char*> pointers(std::vector<std::string>& texts);

}  // namespace cvtflow::tools
