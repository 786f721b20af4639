#include "tools/program/view/machine_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/parameters/chain_layout.hpp"

namespace cvtflow::tools {

engine::RecordedState machine_state(const std::string& path, const engine::RunReader& run, std::size_t number,
                                    const model::ChainLayout& at) {
    engine::RecordedState recorded = run.state(number);
    const bool fits = recorded.state.size() == static_cast<std::size_t>(at.size()) &&
                      recorded.phases.size() == static_cast<std::size_t>(model::tips_per_link * at.links);
    const bool phases = std::all_of(recorded.phases.begin(), recorded.phases.end(),
                                    [](std::uint8_t phase) { return phase <= static_cast<std::uint8_t>(model::Phase::slip); });
    if (!fits || !phases) throw engine::RecordError(fmt::format("{}: state {} does not match its machine", path, number));
    return recorded;
}

bool finite(const engine::RecordedState& recorded) {
    return std::isfinite(recorded.time) &&
           std::all_of(recorded.state.begin(), recorded.state.end(), [](double value) { return std::isfinite(value); });
}

}  // namespace cvtflow::tools
