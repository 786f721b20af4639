#include "engine/thread/pinning.hpp"

#include <algorithm>

namespace cvtflow::engine {

Processors::Processors() noexcept : set_{}, known_(sched_getaffinity(0, sizeof set_, &set_) == 0) {
    if (known_) count_ = std::max(1, CPU_COUNT(&set_));
}

cpu_set_t Processors::only(int number) const noexcept {
    cpu_set_t result;
    CPU_ZERO(&result);
    int left = number % count_;
    for (int processor = 0; processor < CPU_SETSIZE; ++processor) {
        if (!CPU_ISSET(processor, &set_) || left-- > 0) continue;
        CPU_SET(processor, &result);
        break;
    }
    return result;
}

Pin::Pin(bool requested, const Processors& processors, int number) noexcept : before_{}, pinned_(false) {
    if (!requested || !processors.known() || sched_getaffinity(0, sizeof before_, &before_) != 0) return;
    const cpu_set_t only = processors.only(number);
    pinned_ = sched_setaffinity(0, sizeof only, &only) == 0;
}

Pin::~Pin() {
    if (pinned_) sched_setaffinity(0, sizeof before_, &before_);
}

}  // namespace cvtflow::engine
