#include "engine/executor/runtimes.hpp"

#include <oneapi/tbb/version.h>

#include "engine/thread/pinning.hpp"

namespace cvtflow::engine {

std::string tbb_version() { return std::string(TBB_runtime_version()) + ", interface " + std::to_string(TBB_runtime_interface_version()); }

std::string openmp_version() {
#ifdef _OPENMP
    return std::to_string(_OPENMP);
#else
    return "none";
#endif
}

std::string runtime_versions() { return "oneTBB " + tbb_version() + (openmp_version() == "none" ? "" : "; OpenMP " + openmp_version()); }

int usable_processors() { return Processors().count(); }

}  // namespace cvtflow::engine
