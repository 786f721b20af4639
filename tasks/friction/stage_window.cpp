#include "tasks/friction/stage_window.hpp"

#include "tasks/assembly/segment_tasks.hpp"

namespace cvtflow::tasks {

const double* window_of(Workspace& w, const double* state, int segment) noexcept {
    double* window = w.windows[static_cast<std::size_t>(segment)].data();
    copy_window(w, w.partition[segment], state, window);
    return window;
}

}  // namespace cvtflow::tasks
