#include <cvtflow/snapshot.hpp>

#include <string>
#include <utility>

#include "engine/thread/published_numbers.hpp"

namespace cvtflow {
inline namespace v0 {

struct Snapshot::Impl {
    std::vector<std::size_t> channels;
    std::vector<double> taken;
    engine::PublishedNumbers published;
};

Snapshot::Snapshot(Simulation& simulation, const std::vector<std::string>& channels) {
    std::vector<std::size_t> numbers;
    std::size_t size = 1;
    for (const std::string& name : channels) {
        numbers.push_back(simulation.find_channel(name));
        size += simulation.channel_info(numbers.back()).width;
    }
    impl_.reset(new Impl{std::move(numbers), std::vector<double>(size), engine::PublishedNumbers(size)});
    take(simulation);
}

Snapshot::~Snapshot() = default;

void Snapshot::take(Simulation& simulation) {
    std::vector<double>& taken = impl_->taken;
    taken[0] = simulation.time();
    std::size_t at = 1;
    for (const std::size_t channel : impl_->channels)
        for (const double value : simulation.channel(channel)) taken.at(at++) = value;
    impl_->published.publish(taken);
}

std::size_t Snapshot::size() const noexcept { return impl_->taken.size(); }

void Snapshot::read(std::span<double> out) const {
    if (out.size() != size())
        throw Error(ErrorCode::argument, "snapshot: " + std::to_string(out.size()) + " numbers for " + std::to_string(size()));
    impl_->published.read(out);
}

std::vector<double> Snapshot::read() const {
    std::vector<double> values(size());
    read(values);
    return values;
}

}  // namespace v0
}  // namespace cvtflow
