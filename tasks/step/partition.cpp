#include "tasks/step/partition.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace cvtflow::tasks {

Partition Partition::equal(int links, int segments, int grain) {
    if (segments < 1 || segments > links) {
        throw std::invalid_argument("run.segments: " + std::to_string(segments) + " segments for " + std::to_string(links) +
                                    " links; give 1 to " + std::to_string(links));
    }
    Partition partition;
    const int unit = segments <= (links + grain - 1) / grain ? grain : 1, units = (links + unit - 1) / unit;
    for (int s = 0; s < segments; ++s) {
        const auto cut = [&](int k) { return std::min(links, unit * static_cast<int>(static_cast<long>(units) * k / segments)); };
        partition.segments_.push_back({cut(s), cut(s + 1)});
    }
    return partition;
}

Partition Partition::at(const std::vector<int>& cuts) {
    Partition partition;
    for (std::size_t s = 1; s < cuts.size(); ++s) {
        if (cuts[s] <= cuts[s - 1]) throw std::invalid_argument("partition: borders must increase");
        partition.segments_.push_back({cuts[s - 1], cuts[s]});
    }
    if (partition.segments_.empty() || cuts.front() != 0)
        throw std::invalid_argument("partition: borders must begin with 0 and end with the number of links");
    return partition;
}

}  // namespace cvtflow::tasks
