#include "tools/program/report/rainflow_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "engine/base/rainflow.hpp"
#include "engine/base/text.hpp"
#include "engine/record/run/run_reader.hpp"
#include "tasks/scene/csv.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/text/provenance_json.hpp"
#include "tools/program/text/text.hpp"
#include "tools/program/view/recorded_run.hpp"

namespace cvtflow::tools {

namespace {

/// A load over time: one element of a channel.
struct Load {
    std::string name, unit;
    std::vector<double> time, history;
    std::vector<engine::RainflowCycle> cycles;
};

/// Length of the record in rounds of the chain, and duration of a round; zero if the record does not contain them.
struct Rounds {
    double time = 0.0;  ///< of one [s]
    [[nodiscard]] double in(const Load& load) const {
        return time > 0.0 && !load.time.empty() ? (load.time.back() - load.time.front()) / time : 0.0;
    }
};

Rounds rounds_of(const RecordedRun& run) {
    const auto pins = run.pin_frequency();
    return {pins ? run.scene()->parameters.chain.pins / *pins : 0.0};
}

/// Damage-equivalent range: one cycle of it per round of the chain does the same damage by Miner's rule (one cycle per record, if shorter
/// than a round): (sum n_i range_i^m / rounds)^(1/m).
double equivalent_range(const Load& load, double exponent, double rounds) {
    double largest = 0.0, sum = 0.0;
    for (const engine::RainflowCycle& cycle : load.cycles) largest = std::max(largest, cycle.range);
    for (const engine::RainflowCycle& cycle : load.cycles) sum += cycle.count * std::pow(cycle.range / largest, exponent);
    return load.cycles.empty() ? 0.0 : largest * std::pow(sum / std::max(1.0, rounds), 1.0 / exponent);
}

/// The elements that a request names. @throws UsageError
std::vector<int> elements_of(const engine::ChannelInfo& channel, const std::string& request) {
    const auto bracket = request.find('[');
    if (bracket == std::string::npos) {
        if (channel.width == 1) return {0};
        throw UsageError(fmt::format("--rainflow {0}: it has {1} numbers; write {0}[0] ... {0}[{2}], or {0}[*]", channel.name,
                                     channel.width, channel.width - 1));
    }
    const std::string_view index = std::string_view(request).substr(bracket);
    if (index == "[*]") {
        std::vector<int> all(static_cast<std::size_t>(channel.width));
        for (std::size_t k = 0; k < all.size(); ++k) all[k] = static_cast<int>(k);
        return all;
    }
    int element = -1;
    const auto [stop, error] = std::from_chars(index.data() + 1, index.data() + index.size(), element);
    const bool good = error == std::errc() && std::string_view(stop, index.data() + index.size()) == "]";
    if (!good || element < 0 || element >= channel.width)
        throw UsageError(fmt::format("--rainflow {}: elements are numbered 0 to {}", request, channel.width - 1));
    return {element};
}

const engine::ChannelInfo& channel_of(const engine::RunReader& run, const std::string& request) {
    const std::string name = request.substr(0, request.find('['));
    std::vector<std::string> names;
    for (const engine::ChannelInfo& channel : run.channels()) {
        if (channel.name == name) return channel;
        names.push_back(channel.name);
    }
    if (const std::string how = how_to_record(name); !how.empty())
        throw UsageError(fmt::format("--rainflow {}: the run was recorded without this channel ({})", name, how));
    throw UsageError(fmt::format("--rainflow {}: the record has no such channel{} (cvtflow info shows them)", name,
                                 engine::did_you_mean(engine::closest(name, names))));
}

std::vector<Load> loads_of(const engine::RunReader& run, const RainflowRequest& request) {
    std::vector<Load> loads;
    const std::vector<double> times = run.times();
    for (const std::string& requested : request.channels) {
        const engine::ChannelInfo& channel = channel_of(run, requested);
        const std::vector<double> values = run.channel(channel.name);
        const std::size_t width = static_cast<std::size_t>(channel.width);
        for (const int element : elements_of(channel, requested)) {
            Load load{width == 1 ? channel.name : fmt::format("{}[{}]", channel.name, element), channel.unit, {}, {}, {}};
            for (std::size_t row = 0; row < times.size(); ++row) {
                const double value = values[row * width + static_cast<std::size_t>(element)];
                if (times[row] < request.from || times[row] > request.until || !std::isfinite(value)) continue;
                load.time.push_back(times[row]);
                load.history.push_back(value);
            }
            load.cycles = engine::rainflow(load.history);
            loads.push_back(std::move(load));
        }
    }
    return loads;
}

std::string span_text(const Load& load) {
    if (load.time.empty()) return "no outputs";
    return fmt::format("{} outputs from {} to {}", load.time.size(), time_text(load.time.front()), time_text(load.time.back()));
}

/// The equivalent load, and a note for a short record.
std::string damage_text(const Load& load, double exponent, const Rounds& round) {
    const double rounds = round.in(load);
    const std::string each =
        rounds >= 1.0 ? fmt::format("one cycle per round of the chain ({:.3g} rounds)", rounds) : "one cycle in the record";
    std::string text = fmt::format("  damage-equivalent range {:.6g} {} (exponent {:g}, {})\n", equivalent_range(load, exponent, rounds),
                                   load.unit, exponent, each);
    if (rounds > 0.0 && rounds < 1.0)
        text += fmt::format("  note: the record covers {:.2g} of a round of the chain ({}); no link has seen all of its loads\n", rounds,
                            time_text(round.time));
    return text;
}

std::string text_of(const Load& load, int classes) {
    const auto column = [&](const char* name) { return Table::Column{fmt::format("{} [{}]", name, load.unit), Align::right}; };
    Table table({column("range from"), column("to"), {"cycles", Align::right}, column("mean"), column("largest range")});
    const auto number = [](double value) { return fmt::format("{:.6g}", value); };
    for (const engine::RainflowClass& each : engine::rainflow_classes(load.cycles, classes)) {
        if (each.count > 0.0) table.add({number(each.from), number(each.to), number(each.count), number(each.mean), number(each.largest)});
    }
    const std::string head = fmt::format("{}: rainflow counts (ASTM E1049) of {}\n", load.name, span_text(load));
    return head + (load.cycles.empty() ? "  no cycles\n" : table.text(2));
}

std::string csv_of(const std::vector<Load>& loads) {
    std::string text = "load,unit,range,mean,cycles,from_time,to_time\n";
    for (const Load& load : loads) {
        const std::string name = tasks::csv_cell(load.name, true), unit = tasks::csv_cell(load.unit, true);
        for (const engine::RainflowCycle& cycle : load.cycles)
            text += fmt::format("{},{},{},{},{},{},{}\n", name, unit, cycle.range, cycle.mean, cycle.count, load.time[cycle.first],
                                load.time[cycle.second]);
    }
    return text;
}

nlohmann::ordered_json json_of(const Load& load, const RainflowRequest& request, const Rounds& round) {
    auto cycles = nlohmann::ordered_json::array(), counts = nlohmann::ordered_json::array();
    for (const engine::RainflowCycle& cycle : load.cycles)
        cycles.push_back({{"range", cycle.range},
                          {"mean", cycle.mean},
                          {"count", cycle.count},
                          {"from_time", load.time[cycle.first]},
                          {"to_time", load.time[cycle.second]}});
    for (const engine::RainflowClass& each : engine::rainflow_classes(load.cycles, request.classes))
        counts.push_back({{"from", each.from}, {"to", each.to}, {"count", each.count}, {"mean", each.mean}, {"largest", each.largest}});
    const double rounds = round.in(load);
    const nlohmann::ordered_json damage{{"exponent", request.exponent},
                                        {"range", equivalent_range(load, request.exponent, rounds)},
                                        {"reference_cycles", std::max(1.0, rounds)},
                                        {"rounds", rounds}};
    return {{"load", load.name},           {"unit", load.unit}, {"outputs", load.time.size()},
            {"damage_equivalent", damage}, {"classes", counts}, {"cycles", cycles}};
}

}  // namespace

std::string rainflow_report(const RainflowRequest& request) {
    const RecordedRun run(request.record);
    const std::vector<Load> loads = loads_of(run.reader(), request);
    const Rounds round = rounds_of(run);
    if (request.form == RainflowForm::csv) return csv_of(loads);
    if (request.form == RainflowForm::json) {
        auto all = nlohmann::ordered_json::array();
        for (const Load& load : loads) all.push_back(json_of(load, request, round));
        return json_text(
            {{"record", request.record}, {"method", "ASTM E1049 rainflow"}, {"loads", all}, {"provenance", provenance_json()}});
    }
    std::string text;
    for (const Load& load : loads)
        text += (text.empty() ? "" : "\n") + text_of(load, request.classes) + damage_text(load, request.exponent, round);
    return text;
}

}  // namespace cvtflow::tools
