#pragma once
/// A record for pictures and pages: channels by name, and the scene.

#include <optional>
#include <string>
#include <vector>

#include "engine/record/run/run_reader.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::tools {

/// One number over the times of a record.
struct Curve {
    std::string name;  ///< of the channel; of one of several numbers "sheaves/axial_force[2]"
    std::string unit, description;
    std::vector<double> values;
};

/// Advice for a channel or group that was not recorded: "record it with --set record.channels=NAME". Empty: the name is unknown.
[[nodiscard]] std::string how_to_record(const std::string& name);

class RecordedRun {
public:
    /// @throws engine::RecordError as RunReader, and for a record without a row
    explicit RecordedRun(std::string path);

    [[nodiscard]] const std::string& path() const noexcept { return path_; }
    /// Of its scene.
    [[nodiscard]] std::string name() const;
    [[nodiscard]] const engine::RunReader& reader() const noexcept { return reader_; }
    /// Empty if this program cannot read it.
    [[nodiscard]] const std::optional<tasks::Scene>& scene() const noexcept { return scene_; }
    /// "baseline, rk4, 50 ns".
    [[nodiscard]] std::string conditions() const;
    /// Times of the rows [s].
    [[nodiscard]] const std::vector<double>& times() const noexcept { return times_; }

    /// All numbers of a channel; of one with more than four, three curves: its minimum, mean and maximum. @param each all numbers as well
    [[nodiscard]] std::vector<Curve> curves(const engine::ChannelInfo& channel, bool each = false) const;
    /// Curves of a channel, a group ("shaft_1"), or one number of a channel ("links/tension[12]").
    /// @throws UsageError with the closest name
    [[nodiscard]] std::vector<Curve> find(const std::string& word, bool each = false) const;
    /// Scalar channels outside any group: the main quantities of a run.
    [[nodiscard]] std::vector<Curve> overview() const;
    /// Channels of one group, in order of declaration.
    [[nodiscard]] std::vector<Curve> group(const std::string& name, bool each = false) const;

    /// Pins that pass a place, by the mean speed of the chain and its mean pitch [Hz]; empty if the record does not contain them.
    [[nodiscard]] std::optional<double> pin_frequency() const;
    /// Why outputs are too far apart for spectra, with the interval that they require: passing pins would be aliased. Empty if they are
    /// not.
    [[nodiscard]] std::string unresolved() const;

private:
    std::string path_;
    engine::RunReader reader_;
    std::optional<tasks::Scene> scene_;
    std::vector<double> times_;
};

}  // namespace cvtflow::tools
