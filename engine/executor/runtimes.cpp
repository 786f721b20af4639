#include "engine/executor/runtimes.hpp"

#include <oneapi/tbb/version.h>

#if CVTFLOW_HAS_ASIO
#include <boost/version.hpp>
#endif
#if CVTFLOW_HAS_TASKFLOW
#include <taskflow/taskflow.hpp>
#endif

#include <utility>

#include "engine/thread/pinning.hpp"

namespace cvtflow::engine {

namespace {

[[maybe_unused]] std::string version_text(int major, int minor, int patch) {
    return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

}  // namespace

std::string tbb_version() { return std::string(TBB_runtime_version()) + ", interface " + std::to_string(TBB_runtime_interface_version()); }

std::string openmp_version() {
#ifdef _OPENMP
    return std::to_string(_OPENMP);
#else
    return "none";
#endif
}

std::string asio_version() {
#if CVTFLOW_HAS_ASIO
    return version_text(BOOST_VERSION / 100000, BOOST_VERSION / 100 % 1000, BOOST_VERSION % 100);
#else
    return "none";
#endif
}

std::string taskflow_version() {
#if CVTFLOW_HAS_TASKFLOW
    return version_text(TF_MAJOR_VERSION, TF_MINOR_VERSION, TF_PATCH_VERSION);
#else
    return "none";
#endif
}

std::string runtime_versions() {
    std::string text = "oneTBB " + tbb_version();
    for (const auto& [name, version] :
         {std::pair{"OpenMP ", openmp_version()}, std::pair{"Boost ", asio_version()}, std::pair{"Taskflow ", taskflow_version()}}) {
        if (version != "none") text += std::string("; ") + name + version;
    }
    return text;
}

int usable_processors() { return Processors().count(); }

}  // namespace cvtflow::engine
