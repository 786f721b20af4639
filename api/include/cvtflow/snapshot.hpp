#pragma once
/// Values of a few channels that other threads may read while a simulation steps: for displays and loggers beside a control loop.
///
///     cvtflow::Snapshot gauges(simulation, {"slip", "shaft_1/torque"});
///     simulation.on_output(1e-3, [&](cvtflow::Simulation& now) { gauges.take(now); });
///     ...  any thread:  const std::vector<double> values = gauges.read();

#include <cvtflow/simulation.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace cvtflow {
inline namespace v0_4 {

/// A sequence lock: the writer never waits.
class Snapshot {
public:
    /// Takes the values of now. @param channels their names   @throws Error (argument) for a name that is no channel; busy
    Snapshot(Simulation& simulation, const std::vector<std::string>& channels) {
        std::size_t size = 1;
        for (const std::string& name : channels) {
            channels_.push_back(simulation.find_channel(name));
            size += simulation.channel_info(channels_.back()).width;
        }
        numbers_ = std::vector<std::atomic<double>>(size);
        take(simulation);
    }
    Snapshot(const Snapshot&) = delete;
    Snapshot& operator=(const Snapshot&) = delete;

    /// Takes the values of a simulation of the same scene, on its thread: between steps or in its callback. Never waits for readers.
    /// Observes only what these channels require. @throws Error busy
    void take(Simulation& simulation) {
        for (const std::size_t channel : channels_) static_cast<void>(simulation.channel(channel));  // what may throw
        const std::uint64_t before = version_.load(std::memory_order_relaxed);
        version_.store(before + 1, std::memory_order_relaxed);
        std::atomic_thread_fence(std::memory_order_release);
        std::size_t at = 0;
        numbers_[at++].store(simulation.time(), std::memory_order_relaxed);
        for (const std::size_t channel : channels_)
            for (const double value : simulation.channel(channel)) numbers_.at(at++).store(value, std::memory_order_relaxed);
        version_.store(before + 2, std::memory_order_release);
    }

    /// Numbers of a snapshot: time [s], then the values of the channels in their order, channels of several numbers in full.
    [[nodiscard]] std::size_t size() const noexcept { return numbers_.size(); }
    /// The last values taken, all of one moment. From any number of threads; begins again while a value is being replaced, which takes less
    /// than a microsecond. Allocates nothing. @param out [size()]   @throws Error (argument) for another length
    void read(std::span<double> out) const {
        if (out.size() != size())
            throw Error(ErrorCode::argument, "snapshot: " + std::to_string(out.size()) + " numbers for " + std::to_string(size()));
        for (;;) {
            const std::uint64_t before = version_.load(std::memory_order_acquire);
            for (std::size_t k = 0; k < size(); ++k) out[k] = numbers_[k].load(std::memory_order_relaxed);
            std::atomic_thread_fence(std::memory_order_acquire);
            if (before % 2 == 0 && version_.load(std::memory_order_relaxed) == before) return;
        }
    }
    [[nodiscard]] std::vector<double> read() const {
        std::vector<double> values(size());
        read(values);
        return values;
    }

private:
    std::vector<std::size_t> channels_;
    std::vector<std::atomic<double>> numbers_;
    std::atomic<std::uint64_t> version_{0};  ///< odd while numbers are replaced
};

}  // namespace v0_4
}  // namespace cvtflow
