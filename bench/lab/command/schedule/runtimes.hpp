#pragma once
/// OpenMP's runtimes beside one another. They have one binary interface, so the program runs with each of them: loaded before the one that
/// it is linked with. A runtime reads its wait policy when it is loaded, so every combination is a process of its own.

#include <string>
#include <vector>

#include "bench/lab/show.hpp"

namespace cvtflow::bench {

/// Whether this process is one of those that other_runtimes() started.
[[nodiscard]] bool is_runtime_child() noexcept;
/// Leaves the results of such a process to the one that started it. @throws std::runtime_error
void hand_back(const Json& profile);

/// Runs this command line again with every runtime and wait policy (the runtime's default, active, passive), in turns.
/// @param libraries  files of further runtimes; none: LLVM's libomp where the system has it
/// @return "profiles": what each process handed back; "complaints": runtimes that were not in use
/// @throws std::runtime_error for a library that does not exist, or a process that failed
[[nodiscard]] Json profiles_by_runtime(std::vector<std::string> libraries);

}  // namespace cvtflow::bench
