#include "bench/summary/summary.hpp"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>

#include "model/basis/lanes.hpp"

namespace cvtflow::bench {

namespace {

/// Eight independent chains of additions and of multiplications each.
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

}  // namespace

double peak_flops(model::Isa isa) {
    if (isa > model::compiled_isa) return 0.0;
    return isa == model::Isa::baseline ? peak<2>() : isa == model::Isa::avx2 ? peak<4>() : peak<8>();
}

namespace {

struct Goal {
    const char* who;
    double speedup;  ///< speed of the whole over one_lane
};
constexpr Goal goals[] = {{"one_lane", 1.0}, {"baseline", 2.0}, {"avx2", 3.5}, {"avx512", 5.0}};

}  // namespace

void SummaryReporter::ReportRuns(const std::vector<Run>& runs) {
    for (const Run& run : runs) {
        if (run.run_type != Run::RT_Iteration) continue;
        const auto [known, added] = times_.emplace(run.benchmark_name(), run.GetAdjustedCPUTime());
        if (!added) known->second = std::min(known->second, run.GetAdjustedCPUTime());
    }
    ConsoleReporter::ReportRuns(runs);
}

double SummaryReporter::time(const std::string& row) const {
    const auto known = times_.find(row);
    return known == times_.end() ? 0.0 : known->second;
}

void SummaryReporter::print_speedups(const std::string& who, double goal) const {
    const double whole = time(who + "/whole");
    if (whole == 0.0) return;
    std::string text = fmt::format("{:9} whole {:7.2f} us", who, whole);
    const double plain = time("plain/whole"), one_lane = time("one_lane/whole");
    if (plain > 0.0) text += fmt::format(", {:5.1f} times faster than plain", plain / whole);
    if (one_lane > 0.0) text += fmt::format(", {:5.2f} than one lane (goal {:g})", one_lane / whole, goal);
    if (time(who + "/smoothed") > 0.0)
        text += fmt::format("; smoothed law {:+.1f} % (goal 3)", 100.0 * (time(who + "/smoothed") / whole - 1.0));
    if (time(who + "/lowest") > 0.0) text += fmt::format("; lowest detail 1/{:.1f} of it (goal 1/8)", whole / time(who + "/lowest"));
    fmt::print("{}\n", text);
    std::string parts;
    for (const char* part : {"inner", "plates", "joints", "tips"}) {
        const double here = time(who + "/" + part);
        if (here == 0.0) continue;
        parts += fmt::format("  {} {:.2f} us", part, here);
        if (time(std::string("plain/") + part) > 0.0)
            parts += fmt::format(" (1/{:.0f} of plain)", time(std::string("plain/") + part) / here);
    }
    if (!parts.empty()) fmt::print("          {}\n", parts);
}

void SummaryReporter::print_summary() const {
    fmt::print("\n");
    for (const Goal& goal : goals) print_speedups(goal.who, goal.speedup);
}

}  // namespace cvtflow::bench
