#pragma once
/// What the rows of bench_rhs say together: speed-ups against the plain code and the goals.

#include <benchmark/benchmark.h>

#include <map>
#include <string>

namespace cvtflow::bench {

/// Prints rows as they come and keeps their times.
class SummaryReporter : public benchmark::ConsoleReporter {
public:
    void ReportRuns(const std::vector<Run>& runs) override;
    /// Only of rows that ran.
    void print_summary() const;

private:
    /// Of one iteration, as often as the row was repeated the shortest [µs]; 0 if it did not run.
    [[nodiscard]] double time(const std::string& row) const;
    void print_speedups(const std::string& who, double goal) const;

    std::map<std::string, double> times_;
};

}  // namespace cvtflow::bench
