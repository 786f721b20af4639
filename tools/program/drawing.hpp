#pragma once
/// The picture that the Python package draws of what `cvtflow tune` has measured: it receives a request and returns the bytes of a file.

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace cvtflow::tools {

/// Starts the package as become_python() does. Its warnings go to stderr.
/// @param request  as api/python/cvtflow/commands/draw.py takes it; what is not finite becomes null
/// @throws UsageError, std::runtime_error: the message of the package; of a missing interpreter or library, what to install
[[nodiscard]] std::string drawn(const nlohmann::json& request);

}  // namespace cvtflow::tools
