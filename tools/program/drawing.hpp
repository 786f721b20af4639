#pragma once
/// Pictures and pages, which the Python package draws, and load cycles, which it counts: it receives one request and returns the bytes of a
/// file. Rules for files, marks and inputs stay with the command; Python knows no output path.

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace cvtflow::tools {

/// Starts the package of this installation or build tree and hands it the request. Its warnings go to stderr.
///
/// The interpreter is CVTFLOW_PYTHON, an absolute path, else the one that CMake found. It runs isolated (python3 -I), in the root folder
/// and with few variables of the environment: nothing in the working folder, PYTHONPATH or the user's packages has an effect.
/// @param request  "tuning": results, "format", "mark"; what is not finite becomes null
/// @param reports  whether it reports progress: it inherits this stderr as the descriptor CVTFLOW_PROGRESS
/// @return a whole picture, page or table
/// @throws UsageError, std::runtime_error: the message of the package; of a missing interpreter or library, what to install
[[nodiscard]] std::string drawn(const nlohmann::json& request, bool reports = false);

/// An absolute path whose bytes are the characters of a text: JSON has no other way to hold any path.
[[nodiscard]] std::string path_for_python(const std::string& path);

}  // namespace cvtflow::tools
