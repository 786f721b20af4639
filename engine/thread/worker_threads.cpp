#include "engine/thread/worker_threads.hpp"

#include <oneapi/tbb/global_control.h>
#include <unistd.h>

#include "engine/thread/worker_grant.hpp"

namespace cvtflow::engine {

long process_number() noexcept { return getpid(); }

bool end_worker_threads() noexcept {
    if (workers_were_refused()) return false;
    try {
        oneapi::tbb::task_scheduler_handle handle{oneapi::tbb::attach{}};
        if (!oneapi::tbb::finalize(handle, std::nothrow)) return false;
        forget_workers();
        return true;
    } catch (...) {
        return false;
    }
}

}  // namespace cvtflow::engine
