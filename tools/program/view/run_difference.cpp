#include "tools/program/view/run_difference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tasks/scene/parameter_table.hpp"
#include "tools/program/plot/finite.hpp"

namespace cvtflow::tools {

namespace {

/// The value at `time` of a line through points, ascending; `time` lies within them.
double on_line(const std::vector<double>& times, const std::vector<double>& values, double time) {
    const auto after = std::lower_bound(times.begin(), times.end(), time);
    const auto k = static_cast<std::size_t>(after - times.begin());
    if (k == 0 || times[k] == time) return values[k];
    const double share = (time - times[k - 1]) / (times[k] - times[k - 1]);
    return values[k - 1] + share * (values[k] - values[k - 1]);
}

double mean_from(const std::vector<double>& values, std::size_t first) { return FiniteFigures(std::span(values).subspan(first)).mean; }

ChannelDifference of_channel(const Curve& curve, std::vector<double> a, const std::vector<double>& b, const std::vector<double>& times) {
    ChannelDifference d{curve, {}, {}, 0.0, times.front()};
    const std::size_t fifth = 4 * a.size() / 5;
    d.all = {mean_from(a, 0), mean_from(b, 0)};
    d.last = {mean_from(a, fifth), mean_from(b, fifth)};
    for (std::size_t k = 0; k < a.size(); ++k) {
        a[k] = b[k] - a[k];
        if (std::abs(a[k]) > d.largest) d.largest = std::abs(a[k]), d.largest_time = times[k];
    }
    d.curve.values = std::move(a);
    return d;
}

}  // namespace

double MeanDifference::relative() const noexcept { return a != 0.0 ? (b - a) / std::abs(a) : std::numeric_limits<double>::quiet_NaN(); }

RunDifference difference(const RecordedRun& a, const RecordedRun& b) {
    RunDifference result;
    const std::vector<double>&ours = a.times(), &theirs = b.times();
    const auto first = std::lower_bound(ours.begin(), ours.end(), theirs.front());
    const auto last = std::upper_bound(first, ours.end(), theirs.back());
    const auto begin = first - ours.begin(), end = last - ours.begin();
    result.times.assign(first, last);
    const std::vector<Curve> of_a = a.overview(), of_b = b.overview();
    const auto named = [](const std::vector<Curve>& curves, const std::string& name) {
        return std::find_if(curves.begin(), curves.end(), [&](const Curve& curve) { return curve.name == name; });
    };
    for (const Curve& curve : of_b) {
        if (named(of_a, curve.name) == of_a.end()) result.only_b.push_back(curve.name);
    }
    for (const Curve& curve : of_a) {
        const auto other = named(of_b, curve.name);
        if (other == of_b.end()) {
            result.only_a.push_back(curve.name);
        } else if (!result.times.empty()) {
            std::vector<double> there;
            for (const double time : result.times) there.push_back(on_line(theirs, other->values, time));
            result.channels.push_back(of_channel({curve.name, curve.unit, curve.description, {}},
                                                 {curve.values.begin() + begin, curve.values.begin() + end}, there, result.times));
        }
    }
    return result;
}

std::vector<KeyDifference> differing_keys(const tasks::Scene& a, const tasks::Scene& b) {
    std::vector<KeyDifference> keys;
    for (const tasks::Parameter& parameter : tasks::parameter_table()) {
        if (parameter.section() == "scene") continue;
        KeyDifference each{std::string(parameter.key), tasks::readable_value(parameter, a), tasks::readable_value(parameter, b),
                           std::string(parameter.meaning)};
        if (each.a != each.b) keys.push_back(std::move(each));
    }
    return keys;
}

}  // namespace cvtflow::tools
