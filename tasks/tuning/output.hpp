#pragma once
/// Outputs of a run whose accuracy is measured, and their errors.

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tasks/batch/sweep/scalar.hpp"
#include "tasks/run/run_means.hpp"

namespace cvtflow::tasks {

/// Errors of slip are relative to at least this value: creep below a ten-thousandth is treated as zero.
inline constexpr double min_slip = 1e-4;

/// |is - expected| over |expected|, or over `least` where that is less: the error of a single figure, such as a mean. is, expected, least
/// [the same unit]
[[nodiscard]] double relative_difference(double is, double expected, double least) noexcept;

/// Values that figures are read from: means over the outputs of the part of a run that counts.
struct FigureMeans {
    SpanMeans span;
    double tip = 0.0;     ///< mean of the largest axial force of an end of a pin [N]
    double thrust = 0.0;  ///< mean of S_1/S_2 [1]
};

/// A row of the catalogue.
struct Figure {
    std::string_view name, meaning;
    double (*read)(const FigureMeans& means);
    bool needs_pulleys;
    bool usual;                                         ///< part of the default outputs
    double least = std::numeric_limits<double>::min();  ///< an error is |is - expected| over |expected|, or over this where that is less
};
[[nodiscard]] std::span<const Figure> figures() noexcept;

/// A figure, or a scalar as in a sweep ("slip median", "tips/axial_force[*] max").
struct TunedOutput {
    std::string name;
    const Figure* figure = nullptr;  ///< nullptr: the scalar
    Scalar scalar{};

    [[nodiscard]] double error(double is, double expected) const noexcept;  ///< relative [1]. is, expected [unit of the output]
};

/// Outputs by their names; none: the usual figures that the machine has.
/// @throws SceneError for a name that is neither figure nor scalar, or a figure of pulleys in a scene without pulleys
[[nodiscard]] std::vector<TunedOutput> tuned_outputs(const std::vector<std::string>& names, bool has_pulleys);
/// The scalars of a sweep.
[[nodiscard]] std::vector<TunedOutput> tuned_outputs(std::span<const Scalar> scalars);

/// Reads outputs of a run, from a time on.
class OutputReader final : public RunObserver {
public:
    /// @param variator, outputs must outlive this @param from begin of the part that counts [s]
    OutputReader(const model::Variator& variator, std::span<const TunedOutput> outputs, int followed_pin, double from);

    /// time [s]
    void output(double time, const Workspace& workspace, const Counters& counters) override;
    [[nodiscard]] bool samples(double time) const noexcept override { return means_.curve().due(time); }
    void sample(double time, const Workspace& workspace, const Counters& counters) override;
    void transition(const TransitionRecord&) override {}

    /// Value of every output, in its unit; not a number if no output counted.
    [[nodiscard]] std::vector<double> values() const;
    [[nodiscard]] const RunMeans& means() const noexcept { return means_; }

private:
    const model::Observation& reduce(double time, const Workspace& workspace, const Counters& counters, const Occasion& when);  ///< [s]

    model::Observer observer_;
    std::span<const TunedOutput> outputs_;
    int followed_pin_;
    double from_;  ///< [s]
    RunMeans means_;
    double tip_ = 0.0, thrust_ = 0.0;  ///< sums [N], [1]
    long count_ = 0;
    std::vector<Reducer> reducers_;
    std::vector<double> numbers_;  ///< numbers of one channel
};

}  // namespace cvtflow::tasks
