#include "engine/method/catalogue.hpp"

#include <algorithm>

namespace cvtflow::engine {

StagePlan euler();
StagePlan heun();
StagePlan rk38();
StagePlan rk4();

std::span<const StagePlan> methods() {
    static const std::vector<StagePlan> all{
        rk4(),
        rk38(),
        heun(),
        euler(),
    };
    return all;
}

const StagePlan* find_method(std::string_view name) {
    const std::span<const StagePlan> all = methods();
    const auto found = std::find_if(all.begin(), all.end(), [&](const StagePlan& plan) { return plan.name == name; });
    return found == all.end() ? nullptr : &*found;
}

}  // namespace cvtflow::engine
