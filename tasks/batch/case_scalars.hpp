#pragma once
/// Scalars and means of a case of a sweep while it runs. Internal to tasks/batch.

#include <span>
#include <vector>

#include "tasks/batch/sweep/sweep.hpp"
#include "tasks/run/run_means.hpp"

namespace cvtflow::tasks {

struct CaseResult;

/// Where scalars are read from at an instant of a case.
struct CaseInstant {
    double time;  ///< [s]
    const Workspace& workspace;
    const Counters& counters;
    model::Observer& observer;
    int followed_pin;
};

class CaseScalars {
public:
    explicit CaseScalars(const Sweep& sweep) : sweep_(sweep) {}

    /// Ready for another case.
    void clear();
    /// Since sweep.from, of the samples of scalars.
    [[nodiscard]] RunMeans& means() noexcept { return means_; }
    /// Whether the case ends when it is steady. Scalars are then those of whole pin periods.
    [[nodiscard]] bool by_periods() const noexcept { return means_.rule().limit > 0.0; }
    /// Whether sample() takes an instant between outputs. time [s]
    [[nodiscard]] bool due(double time) const noexcept { return means_.curve().empty() || means_.curve().due(time, samples_per_pitch); }
    void sample(const CaseInstant& now);
    /// @param last  the case ends here
    void output(const CaseInstant& now, bool last);
    /// Writes scalars, their errors and the begin of the means. A scalar of a case that ended well must be finite.
    void write(CaseResult& result) const;

    /// For checkpoints: load() returns the rest of the memory. @throws std::invalid_argument for a malformed memory
    void save(std::vector<double>& memory) const;
    [[nodiscard]] std::span<const double> load(std::span<const double> memory, double time);  ///< @param time of the last output [s]

private:
    void reduce(const CaseInstant& now, const Occasion& when);
    [[nodiscard]] std::span<Reducer> present_reducers();
    void write_steady(std::size_t scalar, CaseResult& result) const;

    const Sweep& sweep_;
    std::vector<Reducer> reducers_;  ///< [scalars], or of every pin period [periods x scalars]
    RunMeans means_;
    double output_before_ = 0.0;  ///< time of the last output [s]
    std::vector<double> values_;  ///< of one channel [width of the channel]
};

}  // namespace cvtflow::tasks
