#pragma once
/// Values of a few channels that other threads may read while a simulation steps: for displays and loggers beside a control loop.
///
///     cvtflow::Snapshot gauges(simulation, {"slip", "shaft_1/torque"});
///     simulation.on_output(1e-3, [&](cvtflow::Simulation& now) { gauges.take(now); });
///     ...  any thread:  const std::vector<double> values = gauges.read();

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <cvtflow/export.hpp>
#include <cvtflow/simulation.hpp>

namespace cvtflow {
inline namespace v0 {

class CVTFLOW_EXPORT Snapshot {
public:
    /// Takes the values of now. @param channels their names   @throws Error (argument) for a name that is no channel; busy
    Snapshot(Simulation& simulation, const std::vector<std::string>& channels);
    ~Snapshot();
    Snapshot(const Snapshot&) = delete;
    Snapshot& operator=(const Snapshot&) = delete;

    /// Takes the values of a simulation of the same scene, on its thread: between steps or in its callback. Never waits for readers.
    /// Observes only what these channels require. @throws Error busy
    void take(Simulation& simulation);

    /// Numbers of a snapshot: time [s], then the values of the channels in their order, channels of several numbers in full.
    [[nodiscard]] std::size_t size() const noexcept;
    /// The last values taken, all of one moment. From any number of threads; begins again while a value is being replaced, which takes less
    /// than a microsecond. Allocates nothing. @param out [size()]   @throws Error (argument) for another length
    void read(std::span<double> out) const;
    [[nodiscard]] std::vector<double> read() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace v0
}  // namespace cvtflow
