#include "engine/executor/runtimes.hpp"

#include <oneapi/tbb/version.h>

#include "engine/thread/pinning.hpp"

namespace cvtflow::engine {

std::string tbb_version() { return std::string(TBB_runtime_version()) + ", interface " + std::to_string(TBB_runtime_interface_version()); }

std::string runtime_versions() { return "oneTBB " + tbb_version(); }

int usable_processors() { return Processors().count(); }

}  // namespace cvtflow::engine
