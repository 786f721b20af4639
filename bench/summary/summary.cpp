#include "bench/summary/summary.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cvtflow::bench {

namespace {

struct Goal {
    const char* who;
    double speedup;  ///< of whole over one_lane
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
