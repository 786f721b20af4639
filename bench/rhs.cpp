/// Cost of one right-hand side on one thread, whole and by part, at the settled baseline (order 3, 14 plates; 3 and 8 joint points).
/// Every row is the whole chain's share of one evaluation, and carries a hash of what it computed.

#include <benchmark/benchmark.h>

#include <memory>

#include "engine/base/hash.hpp"
#include "model/force/inner.hpp"
#include "model/force/joint.hpp"
#include "model/force/plates.hpp"
#include "model/force/tips.hpp"
#include "model/inertia/link_solve.hpp"
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

void label(benchmark::State& state, const double* values, std::size_t count) {
    state.SetLabel("hash " + engine::hex(engine::state_hash({values, count})));
}

void whole(benchmark::State& run) {
    const Baseline& b = baseline(static_cast<int>(run.range(0)));
    std::vector<double> slope(static_cast<std::size_t>(b.variator().layout().size()));
    model::EvaluationScratch scratch(b.variator().layout());
    for (auto _ : run) {
        model::right_hand_side(b.variator(), 0.0, b.simulation->state(), b.phases.data(), slope.data(), scratch);
        benchmark::DoNotOptimize(slope.data());
    }
    label(run, slope.data(), slope.size());
}

/// Runs body(link, force) over all links with forces cleared, as often as wanted.
template <class Body>
void over_links(benchmark::State& run, const Baseline& b, const Body& body) {
    std::vector<double> force(static_cast<std::size_t>(b.links() * size));
    for (auto _ : run) {
        std::fill(force.begin(), force.end(), 0.0);
        for (int link = 0; link < b.links(); ++link) body(link, force.data() + link * size);
        benchmark::DoNotOptimize(force.data());
    }
    label(run, force.data(), force.size());
}

void plates(benchmark::State& run) {
    const Baseline& b = baseline(3);
    over_links(run, b, [&](int link, double* f) {
        model::plates<order, 16, false>(b.coefficients(), b.coefficients().kind(link), b.state(link), b.state(link) + size, f, nullptr);
    });
}

template <int Width>
void joints_of(benchmark::State& run, const Baseline& b) {
    over_links(run, b, [&](int link, double* f) {
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
    over_links(run, b, [&](int link, double* f) {
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
    over_links(run, b, [&](int link, double* f) {
        const double moment =
            model::inner_elasticity<order, false>(b.coefficients(), b.coefficients().kind(link), b.frame(link), b.state(link), b.state(link) + size, f, nullptr);
        model::add_moment<order>(b.frame(link), moment, f);
    });
}

void inertia(benchmark::State& run) {
    const Baseline& b = baseline(3);
    over_links(run, b, [&](int link, double* f) {
        std::copy_n(b.state(link) + size, size, f);
        model::accelerate<order>(b.variator().chain().inertia(), f);
    });
}

void transitions(benchmark::State& run) {
    const Baseline& b = baseline(3);
    over_links(run, b, [&](int link, double* f) {
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

BENCHMARK(whole)->ArgName("joint_points")->Arg(3)->Arg(8)->Unit(benchmark::kMicrosecond);
BENCHMARK(plates)->Unit(benchmark::kMicrosecond);
BENCHMARK(joints)->ArgName("joint_points")->Arg(3)->Arg(8)->Unit(benchmark::kMicrosecond);
BENCHMARK(tips)->Unit(benchmark::kMicrosecond);
BENCHMARK(inner_elasticity)->Unit(benchmark::kMicrosecond);
BENCHMARK(inertia)->Unit(benchmark::kMicrosecond);
BENCHMARK(pulleys)->Unit(benchmark::kMicrosecond);
BENCHMARK(transitions)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
