#pragma once
/// Results of bench_rhs beside its rows: peak performance of this processor, and speed-ups against the plain code and the goals.

#include <benchmark/benchmark.h>

#include <map>
#include <string>

#include "model/basis/isa.hpp"

namespace cvtflow::bench {

// Peak performance of this processor.

/// Additions and multiplications per second in vectors of an instruction set, measured; 0 if this program was compiled for narrower ones.
[[nodiscard]] double peak_flops(model::Isa isa);

// Results of all rows of bench_rhs: speed-ups against the plain code and the goals.

/// Prints rows as they come and keeps their times.
class SummaryReporter : public benchmark::ConsoleReporter {
public:
    void ReportRuns(const std::vector<Run>& runs) override;
    /// Only of rows that ran.
    void print_summary() const;

private:
    /// Time of one iteration, the shortest of all repetitions of the row [µs]; 0 if it did not run.
    [[nodiscard]] double time(const std::string& row) const;
    void print_speedups(const std::string& who, double goal) const;

    std::map<std::string, double> times_;
};

}  // namespace cvtflow::bench
