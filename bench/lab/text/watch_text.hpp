#pragma once
/// Results of a run's energy watch as text and columns, the same in every command that compares runs.

#include <nlohmann/json.hpp>
#include <string>

#include "bench/study/run_watch.hpp"

namespace cvtflow::bench {

/// Residual of the energy balance over the losses, "3.1e-05"; "-" for a run that ended early.
[[nodiscard]] std::string residual_cell(const tasks::Fault& fault, const WatchResult& watch);
/// For a run whose balance does not close; empty for others.
[[nodiscard]] std::string unreliable_remark(const tasks::Fault& fault, const WatchResult& watch);
/// "240 us are 0.3 pin periods: slip and efficiency are means over at least 16 (about 11 ms here)"; empty if it is long enough.
[[nodiscard]] std::string too_short(const WatchResult& watch);

/// Columns of a table in CSV, without a comma at either end.
inline constexpr const char* watch_heading = "status,residual,suspicion,pin_periods,long_enough,mean_slip,efficiency";
[[nodiscard]] std::string watch_csv(const tasks::Fault& fault, const WatchResult& watch);
/// The columns of watch_csv() as an object.
[[nodiscard]] nlohmann::ordered_json watch_json(const tasks::Fault& fault, const WatchResult& watch);

}  // namespace cvtflow::bench
