/// Serial steps in segments, whose memory accesses bench/experiments/crossing_lines traces and counts by cache lines.
///
///     bench_lines SCENE [SEGMENTS [STEPS]]      defaults: 2 segments, 24 steps
///
/// Prints "marker", an address that is written before and after the steps, "ring", where the end of every task is stamped, "ignore",
/// memory that is not the step's, and names of arrays in it: each with its bytes. After the steps one line per stamp: the task's name, or
/// "controller".

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>

#include "bench/study/profile/measure.hpp"
#include "engine/executor/stamp_recorder.hpp"
#include "tasks/scene/ready_scenes.hpp"

namespace {

using namespace cvtflow;

/// All stamps of one thread, in memory whose place is known.
class StampSequence final : public engine::StampRecorder {
public:
    StampSequence() : StampRecorder(1, 100000) {}
    [[nodiscard]] const Track& track() const noexcept { return tracks_.front(); }
    [[nodiscard]] std::size_t bytes() const noexcept { return track().ring.size() * sizeof(Stamp); }
    [[nodiscard]] std::size_t stamp_bytes() const noexcept { return sizeof(Stamp); }
};

[[nodiscard]] std::uintptr_t address_of(const volatile void* object) { return reinterpret_cast<std::uintptr_t>(object); }

void print_range(const char* name, std::uintptr_t begin, std::size_t bytes) { fmt::print("{} {:x} {}\n", name, begin, bytes); }

/// Arrays of the workspace that lines are counted by.
void print_arrays(const tasks::Workspace& w) {
    const auto print = [](const char* name, const auto& array) {
        print_range(name, address_of(std::data(array)), std::size(array) * sizeof *std::data(array));
    };
    const auto size = static_cast<std::size_t>(w.layout().size());
    for (const auto* slots : {&w.states, &w.slopes}) {
        print("slots", *slots);
        for (const double* slot : *slots) print("states", std::span(slot, size));
    }
    for (const double* slot : {w.end_state, w.end_slope}) print("states", std::span(slot, size));
    for (const auto& window : w.windows) print("windows", window);
    print("loads", w.links.loads);
    print("sums", w.links.sums);
    print("phases", w.tips.phases);
    print("phases", w.tips.phases_before);
    print("results", w.segment_results);
    print("step", std::span(&w.step, 1));
    print("sheaves", w.pulleys.sheaves);
    print("workspace", std::span(&w, 1));
}

volatile int marker = 0;

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return fmt::print(stderr, "usage: bench_lines SCENE [SEGMENTS [STEPS]]\n"), 2;
    StampSequence recorder;
    tasks::Schedule schedule;
    schedule.segments = argc > 2 ? std::atoi(argv[2]) : 2;
    bench::Trial trial(tasks::read_scene(tasks::find_scene(argv[1])), schedule, &recorder);
    const_cast<tasks::Simulation&>(trial.simulation()).keep_energies(false);  // whose samples are frequent at first
    trial.run(10);                                                            // the first one is longer than others
    const int on_stack = 0;
    constexpr std::size_t below = 1U << 20, above = 1U << 16;  // of a frame in main
    print_range("marker", address_of(&marker), sizeof marker);
    print_range("ring", address_of(recorder.track().ring.data()), recorder.bytes());
    print_range("ignore", address_of(&recorder.track()), sizeof recorder.track());
    print_range("ignore", address_of(&on_stack) - below, below + above);
    print_arrays(trial.simulation().workspace());
    std::fflush(stdout);
    const std::size_t first = recorder.track().count;
    marker = 1;
    trial.run(argc > 3 ? std::atol(argv[3]) : 24);
    marker = 2;
    const engine::TaskGraph& graph = trial.simulation().integrator().runner().graph();
    for (std::size_t k = first; k < recorder.track().count; ++k) {
        const int what = recorder.track().ring[k].what;
        fmt::print("stamp {} {}\n", k * recorder.stamp_bytes(), what >= 0 ? graph.task(what).name : "controller");
    }
    return 0;
}
