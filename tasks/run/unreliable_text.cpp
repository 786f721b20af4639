#include "tasks/run/unreliable_text.hpp"

#include <fmt/format.h>

namespace cvtflow::tasks {

std::string unreliable_text(double suspicion, const AutoNumber& setting, double step) {
    const std::string advice = setting.automatic()
                                   ? fmt::format("run.step = \"auto\" is too long here; use {:.2g} s, half of the last step", 0.5 * step)
                                   : "use a shorter step, or run.step = \"auto\"";
    return fmt::format("unreliable: the residual of the energy balance is {:.2g} times the tolerance; {}", suspicion, advice);
}

std::string heat_text(const model::HeatBalance& heat) {
    if (!heat.enabled()) return {};
    return fmt::format(
        "  temperature         pulleys {:.3f} K      oil {:.3f} K      heat {:.4g} J: {:.4g} J stored, {:.4g} J to ambient\n",
        heat.pulleys(), heat.oil(), heat.given(), heat.stored(), heat.taken());
}

}  // namespace cvtflow::tasks
