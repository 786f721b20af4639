#pragma once
/// The variables of an FMU, as its description numbers them: a text file in its resources, a line each, written by `cvtflow export-fmu`.
///
///     0 time 1 time
///     1 input 1 load_torque
///     5 output 24 links/tension        value reference, kind, values, name
///     29 output 1 links/tension 3      one element of a channel, counted from 0
///     40 parameter 1 tip.mass

#include <cstdint>
#include <map>
#include <string>

namespace cvtflow::fmi {

enum class VariableKind { time, input, output, parameter };

struct Variable {
    VariableKind kind = VariableKind::time;
    std::size_t width = 1;    ///< values
    std::size_t element = 0;  ///< the first of them in the channel
    std::string name;
};

/// By value reference.
using Variables = std::map<std::uint32_t, Variable>;

/// @throws Error (argument) for malformed lines
[[nodiscard]] Variables read_variables(const std::string& path);

/// All bytes of a file. @throws Error (argument)
[[nodiscard]] std::string read_file(const std::string& path);

}  // namespace cvtflow::fmi
