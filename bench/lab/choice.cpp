#include "bench/lab/choice.hpp"

#include <fmt/format.h>

#include "tasks/scene/scene.hpp"
#include "tasks/scene/units.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::bench {

using namespace tools;

double read_time(const std::string& option, const std::string& text) {
    const auto parsed = tasks::parse_quantity(text);
    const auto* quantity = std::get_if<tasks::Quantity>(&parsed);
    const bool time = quantity != nullptr && (!quantity->has_unit || quantity->dimension == tasks::dimension_of("s"));
    if (!time || !(quantity->value > 0.0)) throw UsageError(fmt::format("{}: '{}' is not a time above 0, such as 40ns", option, text));
    return quantity->value;
}

namespace {

constexpr std::string_view automatic = "auto";

/// 0: automatic [s].
double read_step(const std::string& choice, const std::string& step) { return step == automatic ? 0.0 : read_time(choice, step); }

}  // namespace

std::vector<std::string> read_choice(const std::string& choice) {
    const auto at = choice.find('@'), tilde = choice.find('~');
    if (at == std::string::npos || at == 0 || (tilde != std::string::npos && tilde < at))
        throw UsageError(fmt::format("{}: write METHOD@STEP, METHOD@auto, or METHOD@LONGEST~TOLERANCE for steps by error", choice));
    require_method(choice.substr(0, at));
    const std::string step = choice.substr(at + 1, tilde == std::string::npos ? tilde : tilde - at - 1);
    const double seconds = read_step(choice, step);
    std::vector<std::string> settings{"run.method=" + choice.substr(0, at),
                                      seconds == 0.0 ? fmt::format("run.step={}", automatic) : fmt::format("run.step={:.17g}", seconds)};
    if (tilde != std::string::npos) {
        settings.emplace_back("run.step_control=error");
        settings.push_back("run.tolerance=" + choice.substr(tilde + 1));
    } else {
        settings.emplace_back("run.step_control=fixed");
    }
    return settings;
}

}  // namespace cvtflow::bench
