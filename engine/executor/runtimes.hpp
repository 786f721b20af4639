#pragma once
/// Thread libraries in use: part of the provenance of a time measurement.

#include <string>

namespace cvtflow::engine {

/// "2021.8, interface 12080" of the library in use, which may be newer than the one compiled against.
[[nodiscard]] std::string tbb_version();
/// For people: "oneTBB 2021.8, interface 12080".
[[nodiscard]] std::string runtime_versions();
/// Processors that the calling thread may use.
[[nodiscard]] int usable_processors();

}  // namespace cvtflow::engine
