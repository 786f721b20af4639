#include "tools/program/view/order_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "tools/program/plot/finite.hpp"

namespace cvtflow::tools {

AmplitudeSpectrum amplitude_spectrum(const std::vector<double>& times, std::vector<double> values) {
    AmplitudeSpectrum spectrum;
    if (times.size() != values.size() || values.size() < 8) return spectrum;
    const double distance = times[1] - times[0];
    if (!(distance > 0.0)) return spectrum;
    if (std::abs(times.back() - times[times.size() - 2] - distance) > 1e-3 * distance) values.pop_back();
    const auto count = static_cast<double>(values.size());
    const double mean = FiniteFigures(values).mean;
    for (double& value : values) value = std::isfinite(value) ? value : mean;
    std::vector<double> padded(2 * std::bit_ceil(values.size()));
    double weights = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        const double window = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(k) / count);
        padded[k] = window * (values[k] - mean);
        weights += window;
    }
    std::vector<std::complex<double>> transformed;
    Eigen::FFT<double>().fwd(transformed, padded);
    for (std::size_t k = 0; k <= padded.size() / 2; ++k) {
        spectrum.frequency.push_back(static_cast<double>(k) / (static_cast<double>(padded.size()) * distance));
        spectrum.amplitude.push_back(2.0 * std::abs(transformed[k]) / weights);
    }
    return spectrum;
}

namespace {

constexpr double max_order = 20.0;  ///< up to which multiples are marked
constexpr int max_pattern = 6;      ///< links of a pattern whose multiples can still be distinguished

/// Mean turns of a shaft [Hz]; 0 if the record does not contain them.
double turns(const RecordedRun& run, int shaft) {
    for (const engine::ChannelInfo& channel : run.reader().channels()) {
        if (channel.name != fmt::format("shaft_{}/speed", shaft)) continue;
        const std::vector<double> speed = run.reader().channel(channel.name);
        return FiniteFigures(speed).mean / (2.0 * std::numbers::pi);
    }
    return 0.0;
}

/// Whether pins pass at this order.
bool at_pins(double order) { return std::abs(order - std::round(order)) < 1e-6; }

}  // namespace

int pattern_length(const std::vector<double>& pitch, int links) {
    const auto at = [&](int link) { return pitch[static_cast<std::size_t>(link) % pitch.size()]; };
    for (int length = 1; length < links; ++length) {
        if (links % length != 0) continue;
        bool repeats = true;
        for (int link = length; link < links && repeats; ++link) repeats = at(link) == at(link - length);
        if (repeats) return length;
    }
    return links;
}

std::vector<Repetition> repetitions(const RecordedRun& run) {
    const auto pins = run.pin_frequency();
    if (!pins) return {};
    const model::Chain& chain = run.scene()->parameters.chain;
    std::vector<Repetition> all{{"pins", *pins, true, "#999999"}};
    const int pattern = pattern_length(chain.pitch, chain.pins);
    if (pattern > 1) all.push_back({"pitch pattern", *pins / pattern, pattern <= max_pattern, "#b8860b"});
    all.push_back({"round of the chain", *pins / chain.pins, false, ""});
    for (const int shaft : {1, 2}) {
        if (const double mean = turns(run, shaft); mean > 0.0)
            all.push_back({fmt::format("shaft {}", shaft), mean, false, shaft == 1 ? "#333333" : "#aa3377"});
    }
    return all;
}

std::vector<Series> order_lines(const std::vector<Repetition>& all, double end, std::pair<double, double> range) {
    std::vector<Series> drawn;
    for (const Repetition& each : all) {
        if (each.colour.empty()) continue;
        const bool pins = &each == &all.front();
        Series lines{fmt::format("{}: {:.4g} Hz{}", pins ? "pins pass" : each.name, each.frequency, each.multiples ? " and multiples" : ""),
                     {},
                     Mark::none,
                     pins ? Line::dashed : Line::dotted,
                     each.colour,
                     pins ? 1.0 : 1.4};
        const double first = each.frequency / all.front().frequency, last = std::min(end, each.multiples ? max_order : first);
        for (int multiple = 1; multiple * first <= last; ++multiple) {
            if (!pins && at_pins(multiple * first)) continue;
            for (const double y : {range.first, range.second, static_cast<double>(NAN)}) lines.points.push_back({multiple * first, y});
        }
        drawn.push_back(std::move(lines));
    }
    return drawn;
}

std::string orders_text(const std::vector<Repetition>& all) {
    std::string text = fmt::format("order 1 = {:.4g} Hz", all.front().frequency);
    for (std::size_t k = 1; k < all.size(); ++k)
        text += fmt::format("{} {} {:.3g}", k == 1 ? ";" : ",", all[k].name, all[k].frequency / all.front().frequency);
    return text;
}

}  // namespace cvtflow::tools
