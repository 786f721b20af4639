/// Cost of one right-hand side of the chain on one thread, at the settled baseline, all rows by turns:
///
///     plain      the oracle of the tests in double: the equations written down plainly, tables computed each time
///     one_lane   the source of the kernels as scalar code, nothing vectorised: what lanes alone bring
///     baseline, avx2, avx512   the kernels, per instruction set that this processor runs
///
///     whole      full detail: order 3, 14 plates, 8 joint points, elastic sheaves
///     three      the same with 3 joint points
///     smoothed   the same as whole with the smoothed friction law
///     lowest     order 0, lumped plates, 1 joint point, rigid sheaves
///
///     bench_rhs [ROUNDS]
///
/// Columns: median and least time, factors against plain and one_lane at the same detail, instructions and flops executed (counted one by
/// one), and a hash of what was computed.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <functional>
#include <memory>
#include <string>

#include "bench/count/instructions.hpp"
#include "bench/study/profile/statistics.hpp"
#include "engine/base/hash.hpp"
#include "engine/record/run/state_file.hpp"
#include "model/kernels/available_isas.hpp"
#include "model/kernels/kernels.hpp"
#include "plain/plain_rhs.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/tuning/dial.hpp"

namespace {

using namespace cvtflow;

constexpr auto one_lane = static_cast<model::Isa>(-1);  // bench/one_lane

/// The settled baseline at some detail.
struct Case {
    explicit Case(const std::vector<std::string>& settings) {
        tasks::Scene scene = tasks::read_scene(CVTFLOW_SOURCE_DIR "/scenes/baseline.toml");
        const engine::SavedState settled = engine::read_state(scene.state_file);
        scene.state_file.clear();
        tasks::set_value(scene, "detail.joint_points=8");
        const model::Parameters full = scene.parameters;
        tasks::set_values(scene, settings);
        parameters = scene.parameters;
        simulation = std::make_unique<tasks::Simulation>(scene);
        const engine::SavedState start = tasks::convert_state(settled, full, parameters);
        simulation->reset(scene, &start);
        model::EvaluationScratch scratch(layout());
        variator().pulleys().motions(state() + layout().pulley_begin(), scratch.sheaves);
        for (int link = 0; link < layout().links; ++link) {
            model::TipProbe probe;
            variator().chain().probe(state() + layout().link_begin(link), scratch.sheaves, false, probe);
            for (const double depth : probe.depth) phases.push_back(depth > 0.0 ? model::Phase::touching : model::Phase::free);
        }
    }
    [[nodiscard]] const model::Variator& variator() const { return simulation->workspace().variator; }
    [[nodiscard]] const model::ChainLayout& layout() const { return variator().layout(); }
    [[nodiscard]] const double* state() const { return simulation->workspace().state(); }

    model::Parameters parameters;
    std::unique_ptr<tasks::Simulation> simulation;
    std::vector<model::Phase> phases;
};

struct Row {
    std::string who, what;
    std::function<void(std::vector<double>& slope)> evaluate;
    std::vector<double> slope{}, times{};  ///< times [us]
};

/// One evaluation with kernels of any kind, on a model that has others.
Row row_of(const std::string& who, const std::string& what, const Case& c, const model::ChainKernels& kernels) {
    auto scratch = std::make_shared<model::EvaluationScratch>(c.layout());
    return {who, what, [&c, kernels, scratch](std::vector<double>& slope) {
                slope.resize(static_cast<std::size_t>(c.layout().size()));
                const double* tail = c.state() + c.layout().pulley_begin();
                model::fill_window(c.variator(), c.state(), *scratch);
                c.variator().pulleys().motions(tail, scratch->sheaves);
                kernels.slopes(c.variator().chain(), {0, c.layout().links, scratch->window.data(), scratch->sheaves, c.phases.data()},
                               slope.data(), scratch->loads.data());
                c.variator().close(0.0, tail, c.variator().sheave_forces(c.phases.data(), scratch->loads.data()), nullptr,
                                   slope.data() + c.layout().pulley_begin());
            }};
}

Row plain_row(const Case& c) {
    return {"plain", "whole", [&c](std::vector<double>& slope) {
                const std::span state(c.state(), static_cast<std::size_t>(c.layout().size()));
                slope = plain::right_hand_side(c.parameters, 0.0, state, c.phases).slope;
            }};
}

void take_turn(Row& row) {
    constexpr double turn = 2e-3;  // [s]
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    std::chrono::duration<double> passed{};
    int calls = 0;
    for (; passed.count() < turn; ++calls, passed = Clock::now() - begin) row.evaluate(row.slope);
    row.times.push_back(1e6 * passed.count() / calls);
}

/// All rows by turns; the first turn of each warms up.
void measure(std::vector<Row>& rows, int rounds) {
    for (int round = -1; round < rounds; ++round) {
        for (Row& row : rows) {
            if (round == 0) row.times.clear();
            take_turn(row);
        }
    }
}

[[nodiscard]] double time_of(const std::vector<Row>& rows, std::string_view who, std::string_view what) {
    const auto row = std::ranges::find_if(rows, [&](const Row& each) { return each.who == who && each.what == what; });
    return row == rows.end() ? NAN : bench::median(row->times);
}

void print(std::vector<Row>& rows) {
    fmt::print("{:<9} {:<9} {:>9} {:>9} {:>9} {:>9} {:>13} {:>9}  hash\n", "", "", "time [us]", "least", "of plain", "one lane",
               "instructions", "flops");
    for (Row& row : rows) {
        const double time = bench::median(row.times);
        bench::Counted counted;  // plain ones take minutes
        if (row.who != "plain") counted = bench::count([&] { row.evaluate(row.slope); }).value_or(counted);
        fmt::print("{:<9} {:<9} {:>9.2f} {:>9.2f} {:>9.1f} {:>9.2f} {:>13} {:>9}  {}\n", row.who, row.what, time,
                   *std::ranges::min_element(row.times), time_of(rows, "plain", "whole") / time, time_of(rows, "one_lane", row.what) / time,
                   counted.instructions, counted.flops, engine::hex(engine::state_hash(row.slope)));
        std::fflush(stdout);  // counting takes seconds
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::pair<const char*, std::vector<std::string>> details[] = {
        {"whole", {}},
        {"three", {"detail.joint_points=3"}},
        {"smoothed", {"detail.friction=smoothed"}},
        {"lowest", {"detail.plates=lumped", "detail.joint_points=1", "detail.pulleys=rigid"}}};
    std::deque<Case> cases;
    std::vector<Row> rows;
    for (const auto& [what, settings] : details) {
        const Case& here = cases.emplace_back(settings);
        if (rows.empty()) rows.push_back(plain_row(here));
        rows.push_back(row_of("one_lane", what, here, model::chain_kernels<one_lane>()));
        for (const model::Isa isa : model::usable_isas())
            rows.push_back(row_of(std::string(model::name_of(isa)), what, here, model::kernels_of(isa).chain()));
    }
    measure(rows, argc > 1 ? std::max(1, std::atoi(argv[1])) : 41);
    print(rows);
    return 0;
}
