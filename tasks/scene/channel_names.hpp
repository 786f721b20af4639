#pragma once
/// Which channels a scene may ask for. The catalogue stands above scenes (tasks/run/channels/channels.cpp), which defines these functions.

#include <span>
#include <string>
#include <vector>

namespace cvtflow::tasks {

/// Of all channels, in the catalogue's order.
[[nodiscard]] std::vector<std::string> channel_names();

/// Names of record.channels that stand for no channel, in their order.
[[nodiscard]] std::vector<std::string> unknown_channels(std::span<const std::string> names);

}  // namespace cvtflow::tasks
