#pragma once
/// The executors that are compared with those of the program: one row each in the source of its runtime.

#include <string>

namespace cvtflow::bench {

/// Adds them to the engine's catalogue, once per process, before any use of the catalogue. Some may be absent from this build.
void add_further_executors();

/// "201511 of libgomp.so.1": the date of the standard that the compiler supports, and the library in use; or "none".
[[nodiscard]] std::string openmp_version();
/// Text for users: "oneTBB 2021.8, interface 12080; OpenMP 201511 of libgomp.so.1; Boost 1.74.0".
[[nodiscard]] std::string runtime_versions();

/// Number of members of an OpenMP team that may be requested: its runtime keeps a team for every thread that ever began one.
[[nodiscard]] int team_grant(int threads) noexcept;

}  // namespace cvtflow::bench
