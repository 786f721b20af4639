#include "bench/lab/text/watch_text.hpp"

#include <fmt/format.h>

#include <cmath>

#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

std::string residual_cell(const tasks::Fault& fault, const WatchResult& watch) {
    return fault ? "-" : fmt::format("{:.1e}", watch.residual);
}

std::string unreliable_remark(const tasks::Fault& fault, const WatchResult& watch) {
    if (fault || watch.reliable()) return {};
    return fmt::format("unreliable: the residual of the energy balance is {:.2g} times the tolerance", watch.balance_error_ratio);
}

std::string too_short(const WatchResult& watch) {
    if (watch.long_enough()) return {};
    return fmt::format("{} are {:.2g} pin periods: means of slip and efficiency require {:g} (about {} here)", time_text(watch.duration),
                       watch.pin_periods(), enough_pin_periods, time_text(enough_pin_periods * watch.pin_period));
}

std::string watch_csv(const tasks::Fault& fault, const WatchResult& watch) {
    if (fault) return fault.name() + ",,,,,,";
    const std::string efficiency = std::isfinite(watch.means.efficiency) ? fmt::format("{:.6g}", watch.means.efficiency) : "";
    return fmt::format("{},{:.3e},{:.3g},{:.3g},{},{:.6g},{}", watch.status(fault), watch.residual, watch.balance_error_ratio,
                       watch.pin_periods(), watch.long_enough() ? "yes" : "no", watch.means.slip, efficiency);
}

nlohmann::ordered_json watch_json(const tasks::Fault& fault, const WatchResult& watch) {
    nlohmann::ordered_json json{{"status", watch.status(fault)}};
    if (fault) return json;
    const nlohmann::ordered_json figures{{"residual", watch.residual},         {"suspicion", watch.balance_error_ratio},
                                         {"pin_periods", watch.pin_periods()}, {"long_enough", watch.long_enough()},
                                         {"mean_slip", watch.means.slip},      {"efficiency", watch.means.efficiency}};
    json.update(figures);
    return json;
}

}  // namespace cvtflow::bench
