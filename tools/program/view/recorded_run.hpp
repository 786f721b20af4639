#pragma once
/// A record for pictures, pages and exports: channels by name, the scene, states.
/// A channel may be undefined (NaN) at some outputs: only finite numbers count.

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/record/run/run_reader.hpp"
#include "model/parameters/chain_layout.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::tools {

/// One number over the times of a record.
struct Curve {
    std::string name;  ///< name of the channel, or of one of its numbers: "sheaves/axial_force[2]"
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
    /// Name of its scene.
    [[nodiscard]] std::string name() const;
    [[nodiscard]] const engine::RunReader& reader() const noexcept { return reader_; }
    /// Empty if this program cannot read it.
    [[nodiscard]] const std::optional<tasks::Scene>& scene() const noexcept { return scene_; }
    /// Times of the rows [s].
    [[nodiscard]] const std::vector<double>& times() const noexcept { return times_; }

    /// All numbers of a channel.
    [[nodiscard]] std::vector<Curve> curves(const engine::ChannelInfo& channel) const;
    /// Curves of a channel, a group ("shaft_1"), or one number of a channel ("links/tension[12]").
    /// @throws UsageError with the closest name
    [[nodiscard]] std::vector<Curve> find(const std::string& word) const;
    /// Channels of one group, in order of declaration.
    [[nodiscard]] std::vector<Curve> group(const std::string& name) const;

private:
    std::string path_;
    engine::RunReader reader_;
    std::optional<tasks::Scene> scene_;
    std::vector<double> times_;
};

/// One state of a record. Its size and phases are compared with the machine, because the file may be forged.
/// @throws engine::RecordError for another number of unknowns or phases, and for invalid phases
[[nodiscard]] engine::RecordedState machine_state(const std::string& path, const engine::RunReader& run, std::size_t number,
                                                  const model::ChainLayout& at);

/// Whether all unknowns are finite.
[[nodiscard]] bool finite(const engine::RecordedState& recorded);

/// NaN where no number is finite.
struct FiniteFigures {
    double mean = std::numeric_limits<double>::quiet_NaN(), least = mean, largest = mean;  ///< [unit of the numbers]

    /// numbers [any unit]
    explicit FiniteFigures(std::span<const double> numbers) {
        double sum = 0.0;
        long count = 0;
        for (const double number : numbers) {
            if (!std::isfinite(number)) continue;
            sum += number, ++count;
            least = std::fmin(least, number), largest = std::fmax(largest, number);
        }
        if (count > 0) mean = sum / static_cast<double>(count);
    }
};

}  // namespace cvtflow::tools
