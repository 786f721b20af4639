#include "tools/method_choice_text.hpp"

#include <fmt/format.h>

#include "tasks/scene/scene.hpp"
#include "tasks/scene/units.hpp"
#include "tools/guard.hpp"

namespace cvtflow::tools {

double read_time(const std::string& option, const std::string& text) {
    const auto parsed = tasks::parse_quantity(text);
    const auto* quantity = std::get_if<tasks::Quantity>(&parsed);
    const bool time = quantity != nullptr && (!quantity->has_unit || quantity->dimension == tasks::dimension_of("s"));
    if (!time || !(quantity->value > 0.0)) throw UsageError(fmt::format("{}: '{}' is not a time above 0, such as 40ns", option, text));
    return quantity->value;
}

std::vector<std::string> read_choice(const std::string& choice) {
    const auto at = choice.find('@'), tilde = choice.find('~');
    if (at == std::string::npos || at == 0 || (tilde != std::string::npos && tilde < at))
        throw UsageError(fmt::format("{}: write METHOD@STEP, or METHOD@LONGEST~TOLERANCE for steps by error", choice));
    const std::string step = choice.substr(at + 1, tilde == std::string::npos ? tilde : tilde - at - 1);
    std::vector<std::string> settings{"run.method=" + choice.substr(0, at), fmt::format("run.step={:.17g}", read_time(choice, step))};
    if (tilde != std::string::npos) {
        settings.emplace_back("run.step_control=error");
        settings.push_back("run.tolerance=" + choice.substr(tilde + 1));
    } else {
        settings.emplace_back("run.step_control=fixed");
    }
    return settings;
}

}  // namespace cvtflow::tools
