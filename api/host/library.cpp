#include <cvtflow/simulation.hpp>
#include <cvtflow/version.hpp>

#include "api/host/floating_defaults.hpp"
#include "engine/thread/worker_threads.hpp"

namespace cvtflow {
inline namespace v0 {

std::string library_version() { return CVTFLOW_VERSION_TEXT; }

bool shutdown() noexcept {
    const api::FloatingDefaults defaults;
    return engine::end_worker_threads();
}

}  // namespace v0
}  // namespace cvtflow
