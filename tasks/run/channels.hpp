#pragma once
/// The catalogue of recorded quantities: a row per channel, from which the record, `list channels` and tests are made.

#include <span>
#include <string_view>

#include "model/observe/observation.hpp"
#include "tasks/step/control/step_controller.hpp"

namespace cvtflow::tasks {

/// What a channel may read at an output time.
struct Instant {
    const model::Observation& observation;
    const Workspace& workspace;
    const Counters& counters;
    int followed_pin;
};

struct Channel {
    std::string_view name;  ///< as in the record; '/' groups
    std::string_view unit;
    std::string_view description;
    std::string_view axis;  ///< label of the second dimension, empty for a plain channel
    int (*width)(const model::ChainLayout&);
    void (*read)(const Instant&, double* values);  ///< values [unit of the channel]
    bool needs_pulleys = true;
};

[[nodiscard]] std::span<const Channel> channels();

/// Short names of loss, work and energy kinds, in the order of their enumerators.
[[nodiscard]] std::string_view loss_name(int kind) noexcept;
[[nodiscard]] std::string_view work_name(int kind) noexcept;
[[nodiscard]] std::string_view energy_name(int kind) noexcept;

}  // namespace cvtflow::tasks
