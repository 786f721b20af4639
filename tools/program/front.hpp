#pragma once
/// Commands that Python carries out: this process becomes the interpreter, so signals, terminal and exit status are the command's own.

#include <span>
#include <string>
#include <vector>

namespace cvtflow::tools {

/// Texts as the system takes the words of a command: a list that ends with nullptr, and is good as long as the texts.
[[nodiscard]] std::vector<char*> pointers(std::vector<std::string>& texts);

/// Replaces this process by the Python package of this installation or build folder: `python3 -I -B -X utf8 PACKAGE/__main__.py WORDS`.
///
/// The interpreter is CVTFLOW_PYTHON, an absolute path, else the one that CMake found. It runs isolated and with few variables of the
/// environment: nothing in the working folder, PYTHONPATH or the user's packages has an effect. CVTFLOW_PROGRAM names this program to it.
/// @param words  command and arguments   @param script  file of the package
/// @throws UsageError, std::runtime_error: what to install where package or interpreter is missing
[[noreturn]] void become_python(std::span<const std::string> words, const std::string& script = "__main__.py");

}  // namespace cvtflow::tools
