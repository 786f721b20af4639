/// Cost of one right-hand side on one thread, whole and by part, at the settled baseline (order 3, 14 plates; 3 and 8 joint points).
/// Every row is the whole chain's share of one evaluation, and carries a hash of what it computed. Rows:
///
///     plain/…      the oracle of the tests in double: the equations written down plainly, tables computed anew
///     one_lane/…   the kernels' own source as scalar code, nothing vectorised: what lanes alone bring
///     whole/ISA/…  the kernels, per instruction set that this processor runs
///     others       parts, compiled for this machine if the build is
///
/// Columns: time, instructions and flops executed (counted one by one), flops per second; whole: share of the measured peak of additions and
/// multiplications in vectors of that instruction set, and bytes of state read and slope written. BENCH_COUNT=0 leaves the counting out.

#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "bench/count/instructions.hpp"
#include "engine/base/hash.hpp"
#include "model/force/inner.hpp"
#include "model/force/joint.hpp"
#include "model/force/plates.hpp"
#include "model/force/tips.hpp"
#include "model/inertia/link_solve.hpp"
#include "model/kernels/kernels.hpp"
#include "plain/plain_rhs.hpp"
#include "tasks/simulation.hpp"

namespace {

using namespace cvtflow;
using model::End;

constexpr int order = 3;
constexpr int block = model::at<order>.link_block();
constexpr int size = model::at<order>.link_size();

/// The settled baseline with everything that a part needs.
struct Baseline {
    explicit Baseline(int joint_points) {
        tasks::Scene scene = tasks::read_scene(CVTFLOW_SOURCE_DIR "/scenes/baseline.toml");
        scene.parameters.detail.joint_points = joint_points;
        parameters = scene.parameters;
        simulation = std::make_unique<tasks::Simulation>(scene);
        const auto& at = variator().layout();
        scratch = std::make_unique<model::EvaluationScratch>(at);
        phases = simulation->phases();
        variator().pulleys().motions(simulation->state() + at.pulley_begin(), scratch->sheaves);
        for (int link = 0; link < at.links; ++link) {
            model::TipProbe probe;
            variator().chain().probe(state(link), scratch->sheaves, probe);
            for (int tip = 0; tip < model::tips_per_link; ++tip) {
                phases[static_cast<std::size_t>(model::tips_per_link * link + tip)] = probe.depth[tip] > 0.0 ? model::Phase::touching : model::Phase::free;
            }
            frames.push_back(model::link_frame<order>(state(link), state(link) + size));
        }
    }
    [[nodiscard]] const model::Variator& variator() const { return simulation->variator(); }
    [[nodiscard]] int links() const { return variator().layout().links; }
    [[nodiscard]] const double* state(int link) const { return simulation->state() + link * block; }
    [[nodiscard]] const model::Coefficients& coefficients() const { return variator().chain().coefficients(); }
    [[nodiscard]] const model::LinkFrame& frame(int link) const { return frames[static_cast<std::size_t>(link)]; }

    model::Parameters parameters;
    std::unique_ptr<tasks::Simulation> simulation;
    std::unique_ptr<model::EvaluationScratch> scratch;
    std::vector<model::Phase> phases;
    std::vector<model::LinkFrame> frames;
};

const Baseline& baseline(int joint_points) {
    static const Baseline three(3);
    static const Baseline eight(8);
    return joint_points == 3 ? three : eight;
}

void label(benchmark::State& state, const double* values, std::size_t count, const std::string& more = "") {
    state.SetLabel("hash " + engine::hex(engine::state_hash({values, count})) + more);
}

/// Instructions, flops and flops per second of one iteration. Counted once per row, though a row is run several times.
bench::Counted count(benchmark::State& run, const std::string& row, const std::function<void()>& body) {
    static std::map<std::string, bench::Counted> known;
    const char* wanted = std::getenv("BENCH_COUNT");
    if (wanted != nullptr && std::string(wanted) == "0") return {};
    if (!known.contains(row)) known[row] = bench::count(body).value_or(bench::Counted{});
    const bench::Counted counted = known[row];
    if (counted.instructions == 0) return {};
    using benchmark::Counter;
    run.counters["instructions"] = Counter(static_cast<double>(counted.instructions));
    run.counters["flops"] = Counter(static_cast<double>(counted.flops));
    run.counters["flop/s"] = Counter(static_cast<double>(counted.flops), Counter::kIsIterationInvariantRate);
    return counted;
}

/// Additions and multiplications per second in vectors of W doubles: eight independent chains of each.
template <int W>
double peak() {
    using model::Lanes;
    std::array<Lanes<W>, 16> value;
    for (std::size_t k = 0; k < value.size(); ++k) value[k] = Lanes<W>(1.0 + static_cast<double>(k));
    const Lanes<W> one(1.0);
    constexpr int rounds = 2'000'000;
    double best = 0.0;
    for (int repetition = 0; repetition < 5; ++repetition) {
        const auto begin = std::chrono::steady_clock::now();
        for (int round = 0; round < rounds; ++round) {
            for (std::size_t k = 0; k < 8; ++k) value[k] += one;
            for (std::size_t k = 8; k < 16; ++k) value[k] = value[k] * one;
        }
        benchmark::DoNotOptimize(value);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        best = std::max(best, 16.0 * W * rounds / seconds);
    }
    return best;
}

/// One evaluation with kernels of any kind, on a model that has others.
void evaluate(const Baseline& b, const model::Variator& variator, const model::ChainKernels& kernels, model::EvaluationScratch& scratch, double* slope) {
    const auto& at = variator.layout();
    model::fill_window(variator, b.simulation->state(), scratch);
    variator.pulleys().motions(b.simulation->state() + at.pulley_begin(), scratch.sheaves);
    kernels.slopes(variator.chain(), {0, at.links, scratch.window.data(), scratch.sheaves, b.phases.data()}, slope, scratch.loads.data(), nullptr);
    variator.close(0.0, b.simulation->state() + at.pulley_begin(), b.phases.data(), scratch.loads.data(), nullptr, slope + at.pulley_begin());
}

/// @param peak_flops [1/s], 0: unknown
void whole(benchmark::State& run, const std::string& row, int joint_points, const model::ChainKernels& kernels, double peak_flops) {
    const Baseline& b = baseline(joint_points);
    std::vector<double> slope(static_cast<std::size_t>(b.variator().layout().size()));
    model::EvaluationScratch scratch(b.variator().layout());
    const auto once = [&] { evaluate(b, b.variator(), kernels, scratch, slope.data()); };
    for (auto _ : run) {
        once();
        benchmark::DoNotOptimize(slope.data());
    }
    label(run, slope.data(), slope.size(), ", " + std::to_string(2 * slope.size() * sizeof(double)) + " bytes in and out, working set " + std::to_string(b.simulation->workspace().bytes() / 1024) + " KiB");
    const auto counted = count(run, row, once);
    if (peak_flops > 0.0) run.counters["peak"] = benchmark::Counter(static_cast<double>(counted.flops) / peak_flops, benchmark::Counter::kIsIterationInvariantRate);
}

void plain_rhs(benchmark::State& run) {
    const Baseline& b = baseline(8);
    const auto& parameters = b.parameters;
    const std::span state(b.simulation->state(), static_cast<std::size_t>(b.variator().layout().size()));
    plain::Result result;
    for (auto _ : run) {
        result = plain::right_hand_side(parameters, 0.0, state, b.phases);
        benchmark::DoNotOptimize(result.slope.data());
    }
    label(run, result.slope.data(), result.slope.size());
}

/// Runs body(link, force) over all links with forces cleared, as often as wanted.
template <class Body>
void over_links(benchmark::State& run, const std::string& row, const Baseline& b, const Body& body) {
    std::vector<double> force(static_cast<std::size_t>(b.links() * size));
    const auto once = [&] {
        std::fill(force.begin(), force.end(), 0.0);
        for (int link = 0; link < b.links(); ++link) body(link, force.data() + link * size);
    };
    for (auto _ : run) {
        once();
        benchmark::DoNotOptimize(force.data());
    }
    label(run, force.data(), force.size());
    count(run, row, once);
}

void plates(benchmark::State& run) {
    const Baseline& b = baseline(3);
    over_links(run, "plates", b, [&](int link, double* f) {
        model::plates<order, 16, false>(b.coefficients(), b.coefficients().kind(link), b.state(link), b.state(link) + size, f, nullptr);
    });
}

template <int Width>
void joints_of(benchmark::State& run, const Baseline& b) {
    over_links(run, "joints" + std::to_string(Width), b, [&](int link, double* f) {
        const int before = b.variator().layout().previous(link);
        model::JointForce<order> out;
        model::joint<order, Width, false>(b.coefficients(), b.frame(before), b.frame(link), b.state(before), b.state(before) + size, b.state(link),
                                          b.state(link) + size, out, nullptr);
        out.on_front.apply(-1.0, f, End::rear);
        model::add_moment<order>(b.frame(link), out.after, f);
    });
}
void joints(benchmark::State& run) {
    if (run.range(0) == 3) return joints_of<4>(run, baseline(3));
    joints_of<8>(run, baseline(8));
}

void tips(benchmark::State& run) {
    const Baseline& b = baseline(3);
    over_links(run, "tips", b, [&](int link, double* f) {
        const model::Phase* phases = b.phases.data() + model::tips_per_link * link;
        if (phases[0] == model::Phase::free && phases[1] == model::Phase::free && phases[2] == model::Phase::free && phases[3] == model::Phase::free) return;
        model::SheaveLoad load;
        const double moment = model::tips<order, false>(b.coefficients(), b.frame(link), b.state(link), b.state(link) + size,
                                                        b.scratch->sheaves + 2 * b.variator().chain().shaft_of(b.state(link)), phases, f, load, nullptr);
        benchmark::DoNotOptimize(load);
        model::add_moment<order>(b.frame(link), moment, f);
    });
}

void inner_elasticity(benchmark::State& run) {
    const Baseline& b = baseline(3);
    over_links(run, "inner_elasticity", b, [&](int link, double* f) {
        const double moment =
            model::inner_elasticity<order, false>(b.coefficients(), b.coefficients().kind(link), b.frame(link), b.state(link), b.state(link) + size, f, nullptr);
        model::add_moment<order>(b.frame(link), moment, f);
    });
}

void inertia(benchmark::State& run) {
    const Baseline& b = baseline(3);
    over_links(run, "inertia", b, [&](int link, double* f) {
        std::copy_n(b.state(link) + size, size, f);
        model::accelerate<order>(b.variator().chain().inertia(), f);
    });
}

void transitions(benchmark::State& run) {
    const Baseline& b = baseline(3);
    over_links(run, "transitions", b, [&](int link, double* f) {
        model::TipProbe probe;
        b.variator().chain().probe(b.state(link), b.scratch->sheaves, probe);
        std::copy_n(probe.depth, model::tips_per_link, f);
    });
}

void pulleys(benchmark::State& run) {
    const Baseline& b = baseline(3);
    const auto& at = b.variator().layout();
    std::vector<double> slope(static_cast<std::size_t>(at.size() - at.pulley_begin()));
    for (auto _ : run) {
        b.variator().close(0.0, b.simulation->state() + at.pulley_begin(), b.phases.data(), b.scratch->loads.data(), nullptr, slope.data());
        benchmark::DoNotOptimize(slope.data());
    }
    label(run, slope.data(), slope.size());
}

BENCHMARK(plain_rhs)->Name("plain/joint_points:8")->Unit(benchmark::kMicrosecond);
BENCHMARK(plates)->Unit(benchmark::kMicrosecond);
BENCHMARK(joints)->ArgName("joint_points")->Arg(3)->Arg(8)->Unit(benchmark::kMicrosecond);
BENCHMARK(tips)->Unit(benchmark::kMicrosecond);
BENCHMARK(inner_elasticity)->Unit(benchmark::kMicrosecond);
BENCHMARK(inertia)->Unit(benchmark::kMicrosecond);
BENCHMARK(pulleys)->Unit(benchmark::kMicrosecond);
BENCHMARK(transitions)->Unit(benchmark::kMicrosecond);

void register_whole(const std::string& name, int joint_points, const model::ChainKernels& kernels, double peak_flops) {
    const std::string row = name + "/joint_points:" + std::to_string(joint_points);
    benchmark::RegisterBenchmark(row.c_str(), [=](benchmark::State& run) { whole(run, row, joint_points, kernels, peak_flops); })->Unit(benchmark::kMicrosecond);
}

void register_instruction_sets() {
    constexpr auto one_lane = static_cast<model::Isa>(-1);   // bench/one_lane
    const double peaks[] = {peak<2>(), peak<4>(), peak<8>()};
    for (const int joint_points : {8, 3}) {
        register_whole("one_lane", joint_points, model::chain_kernels<one_lane>(order), 0.0);
        for (const model::Isa isa : model::usable_isas()) {
            const bool fits = isa <= model::compiled_isa;   // else this file's own vectors are narrower: peak unknown
            register_whole("whole/" + std::string(model::name_of(isa)), joint_points, model::kernels_of(isa).chain(order), fits ? peaks[static_cast<int>(isa)] : 0.0);
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    register_instruction_sets();
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
