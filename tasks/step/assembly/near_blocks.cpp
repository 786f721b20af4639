#include "tasks/step/assembly/near_blocks.hpp"

#include <cstring>

#include "tasks/step/assembly/segment_tasks.hpp"

namespace cvtflow::tasks {

namespace {

/// Calls put(first link, links, place in a window) for a segment's links and `halo` on each side of them.
template <class Put>
void for_each_run(const model::ChainLayout& layout, const Segment& own, int halo, const Put& put) noexcept {
    put(own.first, own.size(), halo);
    for (int k = 0; k < halo; ++k) {
        put(layout.wrapped(own.first + k - halo), 1, k);
        put(layout.wrapped(own.last + k), 1, halo + own.size() + k);
    }
}

/// What workspace.step.row combines for a segment's links and a halo.
void combine_window(const Workspace& w, const Segment& own, int halo, double* window) noexcept {
    const model::ChainLayout& layout = w.layout();
    const int block = layout.link_block();
    for_each_run(layout, own, halo, [&](int link, int links, int place) {
        const int begin = layout.link_begin(link);
        engine::combine(w.step.row, w.step.h, w.slots(), begin, begin + links * block, window + place * block);
    });
}

}  // namespace

void fill_window(Workspace& w, const Segment& own, double* window) noexcept { combine_window(w, own, w.layout().halo(), window); }

void copy_window(const Workspace& w, const Segment& own, const double* state, double* window) noexcept {
    const model::ChainLayout& layout = w.layout();
    const int block = layout.link_block();
    for_each_run(layout, own, layout.halo(), [&](int link, int links, int place) {
        std::memcpy(window + place * block, state + layout.link_begin(link), static_cast<std::size_t>(links * block) * sizeof(double));
    });
}

const double* window_of(Workspace& w, const double* state, int segment) noexcept {
    double* window = w.windows[static_cast<std::size_t>(segment)].data();
    copy_window(w, w.partition[segment], state, window);
    return window;
}

const double* near_at(const Workspace& w, int link, double theta, NearBlocks& blocks) noexcept {
    const model::ChainLayout& layout = w.layout();
    for (int from = -layout.probe_halo(); from <= layout.probe_halo(); ++from) {
        const int begin = layout.link_begin(layout.wrapped(link + from));
        w.interpolant().evaluate(theta, begin, begin + layout.link_block(), blocks.place(layout, from));
    }
    return blocks.place(layout, 0);
}

const double* blocks_at(Workspace& w, int segment, double theta) noexcept {
    const model::ChainLayout& layout = w.layout();
    double* window = w.windows[static_cast<std::size_t>(segment)].data();
    for_each_run(layout, w.partition[segment], layout.probe_halo(), [&](int link, int links, int place) {
        const int begin = layout.link_begin(link);
        w.interpolant().evaluate(theta, begin, begin + links * layout.link_block(), window + place * layout.link_block());
    });
    return window + layout.probe_halo() * layout.link_block();
}

const double* end_blocks(Workspace& w, int segment) noexcept {
    const Segment& own = w.partition[segment];
    if (w.layout().probe_halo() == 0) return w.end_state + w.layout().link_begin(own.first);
    double* window = w.windows[static_cast<std::size_t>(segment)].data();
    combine_window(w, own, w.layout().probe_halo(), window);
    return window + w.layout().probe_halo() * w.layout().link_block();
}

}  // namespace cvtflow::tasks
