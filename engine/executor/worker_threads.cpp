#include "engine/executor/worker_threads.hpp"

#include <oneapi/tbb/global_control.h>

namespace cvtflow::engine {

bool end_worker_threads() noexcept {
    try {
        oneapi::tbb::task_scheduler_handle handle{oneapi::tbb::attach{}};
        return oneapi::tbb::finalize(handle, std::nothrow);
    } catch (...) {
        return false;
    }
}

}  // namespace cvtflow::engine
