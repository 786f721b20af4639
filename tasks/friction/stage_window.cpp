#include "tasks/friction/stage_window.hpp"

#include <cstring>

namespace cvtflow::tasks {

const double* window_of(Workspace& w, const double* state, int segment) noexcept {
    double* window = w.windows[static_cast<std::size_t>(segment)].data();
    const model::ChainLayout& layout = w.layout();
    const Segment& own = w.partition[segment];
    const auto block = static_cast<std::size_t>(layout.link_block());
    const auto copy = [&](int link, int links, double* to) { std::memcpy(to, state + layout.link_begin(link), static_cast<std::size_t>(links) * block * sizeof(double)); };
    copy(layout.previous(own.first), 1, window);
    copy(own.first, own.size(), window + block);
    copy(layout.next(own.last - 1), 1, window + static_cast<std::size_t>(own.size() + 1) * block);
    return window;
}

const double* stage_window(Workspace& w, int segment) noexcept {
    return w.staged_states ? window_of(w, w.stage_state, segment) : w.windows[static_cast<std::size_t>(segment)].data();
}

}  // namespace cvtflow::tasks
