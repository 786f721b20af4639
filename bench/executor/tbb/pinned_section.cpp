#include "bench/executor/tbb/pinned_section.hpp"

#include <unistd.h>

#include <atomic>

namespace cvtflow::bench {

struct ArenaPins::Guest {
    std::atomic<pid_t> thread{0};  // 0: none
    cpu_set_t before;
};

ArenaPins::ArenaPins(oneapi::tbb::task_arena& arena, int slots)
    : task_scheduler_observer(arena), slots_(slots), guests_(std::make_unique<Guest[]>(static_cast<std::size_t>(slots))) {
    observe(true);
}

ArenaPins::~ArenaPins() {
    observe(false);  // returns when no callback is under way
    for (int slot = 0; slot < slots_; ++slot) {
        const Guest& guest = guests_[static_cast<std::size_t>(slot)];
        if (const pid_t thread = guest.thread.load(); thread != 0) sched_setaffinity(thread, sizeof guest.before, &guest.before);
    }
}

void ArenaPins::on_scheduler_entry(bool /*worker*/) {
    const int slot = bench::slot();
    if (slot < 0 || slot >= slots_ || !processors_.known()) return;
    Guest& guest = guests_[static_cast<std::size_t>(slot)];
    const cpu_set_t only = processors_.only(slot);
    if (sched_getaffinity(0, sizeof guest.before, &guest.before) != 0) return;
    if (sched_setaffinity(0, sizeof only, &only) == 0) guest.thread.store(gettid());
}

void ArenaPins::on_scheduler_exit(bool /*worker*/) {
    const int slot = bench::slot();
    if (slot < 0 || slot >= slots_) return;
    Guest& guest = guests_[static_cast<std::size_t>(slot)];
    if (guest.thread.exchange(0) == gettid()) sched_setaffinity(0, sizeof guest.before, &guest.before);
}

}  // namespace cvtflow::bench
