#pragma once
/// Results of a command, which the script bench/lab/show.py prints, writes and draws: computed here, shown there, and nothing comes back.

#include <complex>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "tools/program/output.hpp"

namespace cvtflow::bench {

using Json = nlohmann::ordered_json;

/// An object with these keys, "threads,segments", and as many values. @throws std::invalid_argument for another number of values
[[nodiscard]] Json named(std::string_view keys, std::initializer_list<Json> values);
/// A number, null for one that is not a number, "inf" for an infinite one.
[[nodiscard]] Json number_json(double value);
/// [[real, imaginary], …]
[[nodiscard]] Json values_json(std::span<const std::complex<double>> values);

/// Provenance of the numbers, with compiler flags, libraries and usable threads.
[[nodiscard]] Json machine_json();

/// Ends this process as the script, with the results on its stdin; its exit status is the command's.
/// @param command  name of the function of the script   @param results  its argument; "complaints" (lines for stderr) make the status 1
/// @throws as tools::become_python; std::runtime_error
[[noreturn]] void show(const char* command, Json results, const tools::OutputArguments& output = {});

}  // namespace cvtflow::bench
