#include "bench/lab/report/method/spectrum_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "bench/method/family/fitted.hpp"
#include "tools/program/text/report_columns.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

using nlohmann::ordered_json;

namespace {

std::string complex_text(std::complex<double> value) {
    return value.imag() == 0.0 ? fmt::format("{:.4g}", value.real())
                               : fmt::format("{:.3g} {} {:.4g}i", value.real(), value.imag() < 0.0 ? "-" : "+", std::abs(value.imag()));
}

double largest_modulus(const bench::Eigenvalues& values) {
    double largest = 0.0;
    for (const auto& value : values) largest = std::max(largest, std::abs(value));
    return largest;
}

std::string growth_text(const SpectrumResult& result, const Extent& extent) {
    if (!result.complete) return "not checked: extreme eigenvalues only";
    if (extent.growing == 0)
        return fmt::format("none above {:g} 1/s (largest {:.3g} 1/s, the resolution of the differences)", growth_rate_tolerance,
                           extent.growth);
    return fmt::format("GROWTH: {} above {:g} 1/s, largest {:.4g} 1/s: the state is not settled or unstable",
                       plural(extent.growing, "eigenvalue"), growth_rate_tolerance, extent.growth);
}

std::string shares_table(const Attribution& attribution) {
    Table table({{"caused by"},
                 {"eigenvalues", Align::right},
                 {"below -1e7", Align::right},
                 {"fastest", Align::right},
                 {"slowest", Align::right},
                 {"mean share", Align::right}});
    const auto kinds = contact_kinds();
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
        int count = 0, fast = 0;
        double fastest = 0.0, slowest = 0.0, share = 0.0;
        for (std::size_t k = 0; k < attribution.values.size(); ++k) {
            if (attribution.main_kind(k) != static_cast<int>(kind)) continue;
            const double decay = attribution.values[k].real();
            if (count++ == 0) fastest = decay;
            slowest = decay;
            fast += decay < -1e7 ? 1 : 0;
            share += attribution.shares[k][kind];
        }
        const auto number = [&](double value) { return count > 0 ? fmt::format("{:.3g}", value) : ""; };
        table.add({std::string(kinds[kind].name), std::to_string(count), std::to_string(fast), number(fastest), number(slowest),
                   count > 0 ? fmt::format("{:.2f}", share / count) : ""});
    }
    return table.text(2);
}

std::string slowed_table(const Attribution& attribution) {
    Table table({{"v0 x 10"},
                 {"max -Re", Align::right},
                 {"factor", Align::right},
                 {"max |Im|", Align::right},
                 {"below -1e6", Align::right},
                 {"below -1e7", Align::right}});
    const double before = extent_of(attribution.slowed.front().values).decay;
    for (const SlowedSpectrum& slowed : attribution.slowed) {
        const Extent extent = extent_of(slowed.values);
        table.add({slowed.contacts.empty() ? "none" : slowed.contacts, fmt::format("{:.3e}", extent.decay),
                   fmt::format("{:.2f}", before / extent.decay), fmt::format("{:.3e}", extent.oscillation),
                   std::to_string(extent.below_1e6), std::to_string(extent.below_1e7)});
    }
    return table.text(2);
}

}  // namespace

std::string limit_text(const PlanLimit& limit) {
    const std::string predicted =
        fmt::format("{} predicted (by {} 1/s)", time_text(limit.predicted.step), complex_text(limit.predicted.limiting));
    if (limit.measured.unstable == 0.0) return fmt::format("{}, more than {} measured", predicted, time_text(limit.measured.stable));
    if (limit.measured.stable == 0.0) return fmt::format("{}, less than {} measured", predicted, time_text(limit.measured.unstable));
    const double difference = 100.0 * (limit.measured.limit() / limit.predicted.step - 1.0);
    return fmt::format("{}, {} measured ({:+.2f} %)", predicted, time_text(limit.measured.limit()), difference);
}

std::string spectrum_text(const SpectrumResult& result) {
    const Extent extent = extent_of(result.values);
    std::string text = fmt::format("{}: eigenvalues of the Jacobian at t = {}, {} friction, {} touching\n", result.scene,
                                   time_text(result.time), result.friction, plural(result.touching, "tip"));
    text += field("eigenvalues", result.complete
                                     ? fmt::format("all {}", count_text(result.unknowns))
                                     : fmt::format("{} extreme ones of {}, from a Krylov space of {} (relative residuals up to {:.0e})",
                                                   count_text(static_cast<long>(result.values.size())), count_text(result.unknowns),
                                                   result.dimension, result.residual));
    text += field("strands", fmt::format("{:.0f} N tight, {:.0f} N slack", result.tight, result.slack));
    text += field("fastest decay", fmt::format("max -Re = {:.4e} 1/s", extent.decay));
    text += field("fastest oscillation", fmt::format("max |Im| = {:.4e} 1/s", extent.oscillation));
    text += field("below -1e6, -1e7", fmt::format("{}, {}", extent.below_1e6, extent.below_1e7));
    text += field("growth", growth_text(result, extent));
    text += field("step x |largest|",
                  fmt::format("{:.3f} with {} of {}", result.step * largest_modulus(result.values), time_text(result.step), result.method));
    text += field("largest stable step", result.limit           ? limit_text(*result.limit)
                                         : result.program_limit ? tasks::text_of(*result.program_limit)
                                                                : "not determined");
    constexpr double margin = 1.2;  // of a step's fit, as run.method = "fitted" takes
    const double real = margin * extent.decay * result.step, imaginary = margin * extent.oscillation * result.step;
    if (real >= min_fitted_real && real <= max_fitted_real && imaginary <= max_fitted_imaginary)
        text += field("polynomial for it", fmt::format("cvtflow-lab method fitted-l{:.4g}-w{:.4g}", real, imaginary));
    if (!result.attribution) return text;
    text += fmt::format("\nEigenvalues below -1e6 1/s by the contact that causes them (share: -d ln λ / d ln v0)\n{}",
                        shares_table(*result.attribution));
    return text + fmt::format("\nSaturation speeds v0 ten times as high\n{}", slowed_table(*result.attribution));
}

std::string spectrum_csv(const SpectrumResult& result) {
    std::string text = "real,imaginary";
    for (const ContactKind& kind : contact_kinds()) text += fmt::format(",share_{}", kind.name);
    text += "\n";
    for (std::size_t k = 0; k < result.values.size(); ++k) {
        text += fmt::format("{:.17g},{:.17g}", result.values[k].real(), result.values[k].imag());
        const bool attributed = result.attribution && k < result.attribution->values.size();
        for (int kind = 0; kind < contact_kind_count; ++kind)
            text += attributed ? fmt::format(",{:.6g}", result.attribution->shares[k][static_cast<std::size_t>(kind)]) : ",";
        text += "\n";
    }
    return text;
}

namespace {

ordered_json values_json(const bench::Eigenvalues& values) {
    ordered_json list = ordered_json::array();
    for (const auto& value : values) list.push_back({value.real(), value.imag()});
    return list;
}

ordered_json extent_json(const Extent& extent) {
    return {{"max_decay", extent.decay},
            {"max_oscillation", extent.oscillation},
            {"below_1e6", extent.below_1e6},
            {"below_1e7", extent.below_1e7}};
}

}  // namespace

ordered_json limit_json(const PlanLimit& limit) {
    return {{"method", limit.method},
            {"predicted", limit.predicted.step},
            {"limiting", {limit.predicted.limiting.real(), limit.predicted.limiting.imag()}},
            {"measured", limit.measured.limit()},
            {"measured_stable", limit.measured.stable},
            {"measured_unstable", limit.measured.unstable}};
}

ordered_json limit_json(const std::string& method, const tasks::LargestStep& limit) {  // infinite steps are null
    return {{"method", method}, {"stated", limit.step}, {"rate", limit.rate}};
}

std::string spectrum_json(const SpectrumResult& result) {
    const Extent extent = extent_of(result.values);
    ordered_json json{{"scene", result.scene},       {"provenance", provenance_json()}, {"time", result.time},
                      {"friction", result.friction}, {"touching", result.touching},     {"unknowns", result.unknowns},
                      {"complete", result.complete}};
    json["tight_tension"] = result.tight;
    json["slack_tension"] = result.slack;
    json["extent"] = extent_json(extent);
    if (result.complete) json["growth"] = {{"growing", extent.growing}, {"largest", extent.growth}};
    json["method"] = result.method;
    json["step"] = result.step;
    if (result.limit) json["stable_step"] = limit_json(*result.limit);
    if (result.program_limit) json["stable_step"] = limit_json(result.method, *result.program_limit);
    json["eigenvalues"] = values_json(result.values);
    if (result.attribution) {
        ordered_json slowed = ordered_json::array();
        for (const SlowedSpectrum& spectrum : result.attribution->slowed) {
            ordered_json row = extent_json(extent_of(spectrum.values));
            row["contacts"] = spectrum.contacts;
            row["eigenvalues"] = values_json(spectrum.values);
            slowed.push_back(std::move(row));
        }
        json["slowed_tenfold"] = std::move(slowed);
        json["shares"] = result.attribution->shares;
    }
    return json_text(json);
}

namespace {

std::string conditions(const SpectrumResult& result) {
    return fmt::format("t = {}, {} friction, {} touching; {}{} eigenvalues", time_text(result.time), result.friction,
                       plural(result.touching, "tip"), result.complete ? "all " : "the extreme ",
                       count_text(static_cast<long>(result.values.size())));
}

}  // namespace

Plot edge_plot(const SpectrumResult& result) {
    Plot plot;
    plot.title = fmt::format("Eigenvalues of {} that decay faster", result.scene);
    plot.subtitle = fmt::format("{}; fastest oscillation {:.3g} 1/s", conditions(result), extent_of(result.values).oscillation);
    plot.x = {"-Re λ [1/s]", Scale::logarithmic, 1.0, {}, {}};
    plot.y = {"eigenvalues with a faster decay", Scale::linear, 1.0, 0.0, {}};
    Series all{"all", {}, Mark::none, Line::solid, "#444444"};
    std::vector<Series> kinds;
    const std::size_t attributed = result.attribution ? result.attribution->values.size() : 0;
    if (attributed > 0) {
        for (const ContactKind& kind : contact_kinds())
            kinds.push_back({"caused by " + std::string(kind.name), {}, Mark::none, Line::solid, ""});
    }
    for (std::size_t k = 0; k < result.values.size(); ++k) {  // by falling decay
        const double decay = -result.values[k].real();
        if (decay <= -result.border) continue;
        all.points.push_back({decay, static_cast<double>(all.points.size())});
        if (k >= attributed) continue;
        Series& kind = kinds[static_cast<std::size_t>(result.attribution->main_kind(k))];
        kind.points.push_back({decay, static_cast<double>(kind.points.size())});
    }
    plot.series = {std::move(all)};
    plot.series.insert(plot.series.end(), kinds.begin(), kinds.end());
    return plot;
}

Plot spectrum_plot(const SpectrumResult& result, Scale scale) {
    Plot plot;
    plot.title = fmt::format("Eigenvalues of {}", result.scene);
    plot.subtitle = conditions(result);
    plot.x = {"Re λ [1/s]", scale, 1e3, {}, {}};
    plot.y = {"Im λ [1/s]", scale, 1e3, {}, {}};
    const std::size_t attributed = result.attribution ? result.attribution->values.size() : 0;
    if (attributed > 0) {
        for (const ContactKind& kind : contact_kinds())
            plot.series.push_back({"caused by " + std::string(kind.name), {}, Mark::small_dot, Line::none, ""});
    }
    plot.series.push_back({attributed > 0 ? "others" : "eigenvalues", {}, Mark::small_dot, Line::none, attributed > 0 ? "#444444" : ""});
    for (std::size_t k = 0; k < result.values.size(); ++k) {
        Series& series = k < attributed ? plot.series[static_cast<std::size_t>(result.attribution->main_kind(k))] : plot.series.back();
        series.points.push_back({result.values[k].real(), result.values[k].imag()});
    }
    return plot;
}

Plot slowed_plot(const SpectrumResult& result) {
    Plot plot;
    plot.title = fmt::format("Eigenvalues of {} that decay faster", result.scene);
    plot.subtitle = "by saturation speeds ten times as high";
    plot.x = {"-Re λ [1/s]", Scale::logarithmic, 1.0, {}, {}};
    plot.y = {"eigenvalues with a faster decay", Scale::linear, 1.0, 0.0, {}};
    for (const SlowedSpectrum& slowed : result.attribution->slowed) {
        Series series{slowed.contacts.empty() ? "v0 of the scene" : "v0 x 10: " + slowed.contacts, {}, Mark::none, Line::solid, ""};
        double count = 0.0;
        for (const auto& value : slowed.values) {
            if (value.real() < result.border) series.points.push_back({-value.real(), count++});
        }
        plot.series.push_back(std::move(series));
    }
    return plot;
}

}  // namespace cvtflow::bench
