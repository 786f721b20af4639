#include "tasks/run/unreliable_text.hpp"

#include <fmt/format.h>

namespace cvtflow::tasks {

std::string unreliable_text(double suspicion, const AutoNumber& setting, double step) {
    const std::string advice = setting.automatic()
                                   ? fmt::format("run.step = \"auto\" is too long here; use {:.2g} s, half of the last step", 0.5 * step)
                                   : "use a shorter step, or run.step = \"auto\"";
    return fmt::format("unreliable: the residual of the energy balance is {:.2g} times the tolerance; {}", suspicion, advice);
}

}  // namespace cvtflow::tasks
