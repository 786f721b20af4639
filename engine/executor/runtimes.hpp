#pragma once
/// Thread libraries in use: part of the provenance of a time measurement.

#include <string>

namespace cvtflow::engine {

/// "2021.8, interface 12080" of the library in use, which may be newer than the one compiled against.
[[nodiscard]] std::string tbb_version();
/// "201511" (the standard's date, as the compiler knows it), or "none".
[[nodiscard]] std::string openmp_version();
/// Both, for people: "oneTBB 2021.8, interface 12080; OpenMP 201511".
[[nodiscard]] std::string runtime_versions();
/// Processors that the calling thread may use.
[[nodiscard]] int usable_processors();

}  // namespace cvtflow::engine
