#include "bench/executor/further_executors.hpp"

#include <vector>

#include "bench/executor/compared_executors.hpp"
#include "engine/thread/worker_threads.hpp"

namespace cvtflow::bench {

namespace {

const std::vector<Runtime>& runtimes() {
    static const std::vector<Runtime> all{openmp_runtime(), barrier_runtime(), tbb_runtime(), asio_runtime(), taskflow_runtime()};
    return all;
}

}  // namespace

void add_further_executors() {
    static const bool once = [] {
        for (const Runtime& runtime : runtimes()) engine::add_executors(runtime.rows);
        return true;
    }();
    static_cast<void>(once);
}

std::string runtime_versions() {
    std::string text = "oneTBB " + engine::tbb_version();
    for (const Runtime& runtime : runtimes()) text += runtime.version.empty() ? "" : "; " + runtime.version;
    return text;
}

}  // namespace cvtflow::bench
