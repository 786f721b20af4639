/// Cost of one right-hand side on one thread, whole and by part, at the settled baseline. Rows are WHO/WHAT:
///
///     plain      the oracle of the tests in double: the equations written down plainly, tables computed each time
///     one_lane   the source of the kernels as scalar code, nothing vectorised: what lanes alone bring
///     baseline, avx2, avx512   the kernels, per instruction set that this processor runs
///
///     whole      full detail: order 3, 14 plates, 8 joint points, elastic sheaves
///     three      the same with 3 joint points
///     smoothed   the same as whole with the smoothed friction law
///     lowest     order 0, lumped plates, 1 joint point, rigid sheaves
///     pulleys, transitions and the names of bench/parts/link_parts.hpp: parts of whole, over the whole chain
///
/// Every row is the chain's share of one evaluation and carries a hash of what it computed. Columns: time, instructions and flops executed
/// (counted one by one), flops per second; whole: share of the measured peak of additions and multiplications in vectors of that
/// instruction set, and bytes of state read and slope written. BENCH_COUNT=0 leaves the counting out. A summary compares the rows that ran.

#include <benchmark/benchmark.h>

#include <cstdint>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "bench/count/instructions.hpp"
#include "bench/parts/link_parts.hpp"
#include "bench/study/state_file.hpp"
#include "bench/summary/summary.hpp"
#include "engine/base/hash.hpp"
#include "engine/record/run/state_file.hpp"
#include "model/kernels/available_isas.hpp"
#include "model/kernels/kernels.hpp"
#include "plain/plain_rhs.hpp"
#include "plain/system.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/tuning/dial.hpp"

namespace {

using namespace cvtflow;

constexpr std::string_view settings_of_lowest[] = {"detail.plates=lumped", "detail.joint_points=1", "detail.pulleys=rigid"};

/// The settled baseline at some detail with everything that a row needs.
struct Case {
    explicit Case(tasks::Scene scene)
        : parameters(scene.parameters),
          simulation(scene),
          phases(simulation.workspace().tips.phases),
          scratch(simulation.workspace().layout()) {
        const auto& at = layout();
        variator().pulleys().motions(simulation.workspace().state() + at.pulley_begin(), scratch.sheaves);
        for (int link = 0; link < at.links; ++link) {
            model::TipProbe probe;
            variator().chain().probe(simulation.workspace().state() + at.link_begin(link), scratch.sheaves, false, probe);
            for (int tip = 0; tip < model::tips_per_link; ++tip) {
                phases[static_cast<std::size_t>(model::tips_per_link * link + tip)] =
                    probe.depth[tip] > 0.0 ? model::Phase::touching : model::Phase::free;
            }
        }
        model::fill_window(variator(), simulation.workspace().state(), scratch);
    }
    [[nodiscard]] const model::Variator& variator() const { return simulation.workspace().variator; }
    [[nodiscard]] const model::ChainLayout& layout() const { return variator().layout(); }
    [[nodiscard]] model::ChainRange range() const { return {0, layout().links, scratch.window.data(), scratch.sheaves, phases.data()}; }

    model::Parameters parameters;
    tasks::Simulation simulation;
    std::vector<model::Phase> phases;
    model::EvaluationScratch scratch;
};

tasks::Scene scene_with(const std::string& setting) {
    tasks::Scene scene = tasks::read_scene(CVTFLOW_SOURCE_DIR "/scenes/baseline.toml");
    scene.parameters.detail.joint_points = 8;
    if (!setting.empty()) tasks::set_value(scene, setting);
    return scene;
}

std::unique_ptr<Case> lowest() {
    tasks::Scene scene = scene_with("");
    const engine::SavedState settled = engine::read_state(scene.state_file);
    const model::Parameters full = scene.parameters;
    for (const std::string_view setting : settings_of_lowest) tasks::set_value(scene, std::string(setting));
    const bench::StateFile start(tasks::convert_state(settled, full, scene.parameters));
    scene.state_file = start.path();
    return std::make_unique<Case>(scene);
}

const Case& case_of(const std::string& what) {
    static std::map<std::string, std::unique_ptr<Case>> cases;
    auto& known = cases[what];
    if (known) return *known;
    if (what == "lowest")
        known = lowest();
    else
        known = std::make_unique<Case>(scene_with(what == "three"      ? "detail.joint_points=3"
                                                  : what == "smoothed" ? "detail.friction=smoothed"
                                                                       : ""));
    return *known;
}

void label(benchmark::State& run, const double* values, std::size_t count, const std::string& more = "") {
    run.SetLabel("hash " + engine::hex(engine::state_hash({values, count})) + more);
}

/// Instructions, flops and flops per second of one iteration. Counted once per row, though a row is run several times.
void count(benchmark::State& run, const std::string& row, const std::function<void()>& body, double peak = 0.0) {
    static std::map<std::string, bench::Counted> known;
    const char* requested = std::getenv("BENCH_COUNT");
    if (requested != nullptr && std::string(requested) == "0") return;
    if (!known.contains(row)) known[row] = bench::count(body).value_or(bench::Counted{});
    const bench::Counted counted = known[row];
    if (counted.instructions == 0) return;
    using benchmark::Counter;
    const auto flops = static_cast<double>(counted.flops);
    run.counters["instructions"] = Counter(static_cast<double>(counted.instructions));
    run.counters["flops"] = Counter(flops);
    run.counters["flop/s"] = Counter(flops, Counter::kIsIterationInvariantRate);
    if (peak > 0.0) run.counters["peak"] = Counter(flops / peak, Counter::kIsIterationInvariantRate);
}

/// One evaluation with kernels of any kind, on a model that has others.
void evaluate(const Case& c, const model::ChainKernels& kernels, model::EvaluationScratch& scratch, double* slope) {
    const double* tail = c.simulation.workspace().state() + c.layout().pulley_begin();
    model::fill_window(c.variator(), c.simulation.workspace().state(), scratch);
    c.variator().pulleys().motions(tail, scratch.sheaves);
    kernels.slopes(c.variator().chain(), {0, c.layout().links, scratch.window.data(), scratch.sheaves, c.phases.data()}, slope,
                   scratch.loads.data());
    c.variator().close(0.0, tail, c.variator().sheave_forces(c.phases.data(), scratch.loads.data()), nullptr,
                       slope + c.layout().pulley_begin());
}

/// @param peak flops per second that are possible, 0: unknown
void whole(benchmark::State& run, const std::string& row, const std::string& what, const model::ChainKernels& kernels, double peak) {
    const Case& c = case_of(what);
    std::vector<double> slope(static_cast<std::size_t>(c.layout().size()));
    model::EvaluationScratch scratch(c.layout());
    const auto once = [&] { evaluate(c, kernels, scratch, slope.data()); };
    for (auto _ : run) {
        once();
        benchmark::DoNotOptimize(slope.data());
    }
    label(run, slope.data(), slope.size(),
          ", " + std::to_string(2 * slope.size() * sizeof(double)) + " bytes in and out, working set of a run " +
              std::to_string(c.simulation.workspace().bytes() / 1024) + " KiB");
    count(run, row, once, peak);
}

void part(benchmark::State& run, const std::string& row, int number, const bench::LinkParts& parts) {
    const Case& c = case_of("whole");
    const auto links = static_cast<std::size_t>(c.layout().links);
    std::vector<double> memory(parts.lane_memory(c.layout().links) + 8), out(links * static_cast<std::size_t>(c.layout().link_block()));
    std::vector<model::LinkLoad> loads(links);
    auto* lanes = reinterpret_cast<double*>((reinterpret_cast<std::uintptr_t>(memory.data()) + 63) / 64 * 64);
    const model::ChainRange range = c.range();
    parts.run(0, c.variator().chain(), range, lanes, out.data(), loads.data());
    const auto once = [&] { parts.run(number, c.variator().chain(), range, lanes, out.data(), loads.data()); };
    for (auto _ : run) {
        once();
        benchmark::DoNotOptimize(out.data());
    }
    label(run, out.data(), out.size());
    count(run, row, once);
}

void pulleys(benchmark::State& run) {
    const Case& c = case_of("whole");
    std::vector<double> slope(static_cast<std::size_t>(c.layout().size() - c.layout().pulley_begin()));
    for (auto _ : run) {
        c.variator().close(0.0, c.simulation.workspace().state() + c.layout().pulley_begin(),
                           c.variator().sheave_forces(c.phases.data(), c.scratch.loads.data()), nullptr, slope.data());
        benchmark::DoNotOptimize(slope.data());
    }
    label(run, slope.data(), slope.size());
}

void transitions(benchmark::State& run) {
    const Case& c = case_of("whole");
    std::vector<model::TipProbe> probes(static_cast<std::size_t>(c.layout().links));
    for (auto _ : run) {
        for (int link = 0; link < c.layout().links; ++link) {
            c.variator().chain().probe(c.simulation.workspace().state() + c.layout().link_begin(link), c.scratch.sheaves,
                                       c.parameters.detail.stick_slip, probes[static_cast<std::size_t>(link)]);
        }
        benchmark::DoNotOptimize(probes.data());
    }
    label(run, probes[0].depth, probes.size() * sizeof(model::TipProbe) / sizeof(double));
}

void plain_whole(benchmark::State& run) {
    const Case& c = case_of("whole");
    const std::span state(c.simulation.workspace().state(), static_cast<std::size_t>(c.layout().size()));
    plain::Result result;
    for (auto _ : run) {
        result = plain::right_hand_side(c.parameters, 0.0, state, c.phases);
        benchmark::DoNotOptimize(result.slope.data());
    }
    label(run, result.slope.data(), result.slope.size());
}

/// A part of the oracle on a state that is unpacked already.
void plain_part(benchmark::State& run, void (*add)(const plain::System&, plain::Totals&)) {
    const Case& c = case_of("whole");
    const std::span state(c.simulation.workspace().state(), static_cast<std::size_t>(c.layout().size()));
    const plain::System system = plain::unpack(c.parameters, 0.0, state, c.phases);
    plain::Totals totals = plain::empty_totals(system);
    for (auto _ : run) {
        add(system, totals);
        benchmark::DoNotOptimize(totals);
    }
}

void add_row(const std::string& row, const std::function<void(benchmark::State&)>& body) {
    benchmark::RegisterBenchmark(row.c_str(), body)->Unit(benchmark::kMicrosecond);
}

void add_rows(const std::string& who, const model::ChainKernels& kernels, const bench::LinkParts& parts, double peak) {
    for (const std::string what : {"whole", "three", "smoothed", "lowest"}) {
        const std::string row = who + "/" + what;
        add_row(row, [=](benchmark::State& run) { whole(run, row, what, kernels, what == "whole" ? peak : 0.0); });
    }
    for (std::size_t k = 0; k < bench::link_part_names.size(); ++k) {
        const std::string row = who + "/" + std::string(bench::link_part_names[k]);
        add_row(row, [=](benchmark::State& run) { part(run, row, static_cast<int>(k), parts); });
    }
}

bench::LinkParts parts_of(model::Isa isa) {
    if (isa == model::Isa::baseline) return bench::link_parts<model::Isa::baseline>();
#if defined(__x86_64__)
    return isa == model::Isa::avx2 ? bench::link_parts<model::Isa::avx2>() : bench::link_parts<model::Isa::avx512>();
#endif
}

void register_rows() {
    add_row("plain/whole", plain_whole);
    const std::pair<const char*, void (*)(const plain::System&, plain::Totals&)> plain_parts[] = {
        {"inner", plain::add_inner_elements}, {"plates", plain::add_plates}, {"joints", plain::add_joints}, {"tips", plain::add_tips}};
    for (const auto& [name, add] : plain_parts)
        add_row(std::string("plain/") + name, [add = add](benchmark::State& run) { plain_part(run, add); });
    add_rows("one_lane", model::chain_kernels<bench::one_lane>(), bench::link_parts<bench::one_lane>(), 0.0);
    for (const model::Isa isa : model::usable_isas())
        add_rows(std::string(model::name_of(isa)), model::kernels_of(isa).chain(), parts_of(isa), bench::peak_flops(isa));
    add_row("this_build/pulleys", pulleys);
    add_row("this_build/transitions", transitions);
}

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    register_rows();
    bench::SummaryReporter reporter;
    benchmark::RunSpecifiedBenchmarks(&reporter);
    reporter.print_summary();
    return 0;
}
