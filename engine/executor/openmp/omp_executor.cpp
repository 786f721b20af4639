#include "engine/executor/openmp/omp_executor.hpp"

#include <omp.h>

namespace cvtflow::engine {

void OmpExecutor::release_threads() noexcept { omp_pause_resource_all(omp_pause_hard); }

}  // namespace cvtflow::engine
