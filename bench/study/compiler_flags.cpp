#include "bench/study/compiler_flags.hpp"

std::string cvtflow::bench::compiler_flags() { return CVTFLOW_FLAGS; }
