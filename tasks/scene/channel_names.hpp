#pragma once
/// Channels that a scene may request. Defined by the catalogue in a higher layer (tasks/run/channels.cpp).

#include <span>
#include <string>
#include <vector>

namespace cvtflow::tasks {

/// Of all channels, in the catalogue's order.
[[nodiscard]] std::vector<std::string> channel_names();

/// Unknown names of record.channels, in order.
[[nodiscard]] std::vector<std::string> unknown_channels(std::span<const std::string> names);

}  // namespace cvtflow::tasks
