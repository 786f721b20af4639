#pragma once
/// A record as pictures and pages want it: channels by the words of a person, the scene behind it.

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

/// What to do about a channel, or a group of them, that exists and was not recorded: "record it with --set record.channels=NAME". Empty:
/// there is none of that name.
[[nodiscard]] std::string how_to_record(const std::string& name);

class RecordedRun {
public:
    /// @throws engine::RecordError as RunReader, and for a record without a row
    explicit RecordedRun(std::string path);

    [[nodiscard]] const std::string& path() const noexcept { return path_; }
    [[nodiscard]] const engine::RunReader& reader() const noexcept { return reader_; }
    /// None if this program cannot read it.
    [[nodiscard]] const std::optional<tasks::Scene>& scene() const noexcept { return scene_; }
    /// "baseline, rk4, 50 ns".
    [[nodiscard]] std::string conditions() const;
    /// Times of the rows [s].
    [[nodiscard]] const std::vector<double>& times() const noexcept { return times_; }

    /// All numbers of a channel; of one with more than four, three curves: its least, mean and largest. @param each those numbers as well
    [[nodiscard]] std::vector<Curve> curves(const engine::ChannelInfo& channel, bool each = false) const;
    /// What a word names: a channel, a group ("shaft_1"), or one number of a channel ("links/tension[12]").
    /// @throws UsageError with the name that was probably meant
    [[nodiscard]] std::vector<Curve> find(const std::string& word, bool each = false) const;
    /// Channels of one number that are in no group: what a run is about.
    [[nodiscard]] std::vector<Curve> overview() const;
    /// Channels of one group, in order of declaration.
    [[nodiscard]] std::vector<Curve> group(const std::string& name, bool each = false) const;

    /// Pins that pass a place, by the mean speed of the chain and its mean pitch [Hz]; none where the record does not tell.
    [[nodiscard]] std::optional<double> pin_frequency() const;

private:
    std::string path_;
    engine::RunReader reader_;
    std::optional<tasks::Scene> scene_;
    std::vector<double> times_;
};

}  // namespace cvtflow::tools
