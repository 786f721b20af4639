#include "tools/program/html/curve_data.hpp"

#include <algorithm>

#include "tools/program/html/page.hpp"
#include "tools/program/plot/finite.hpp"
#include "tools/program/view/labels.hpp"

namespace cvtflow::tools {

namespace {

bool constant(const Curve& curve) {
    return std::all_of(curve.values.begin(), curve.values.end(), [&](double value) { return value == curve.values.front(); });
}

/// In the units that people read.
std::vector<Curve> all_curves(const RecordedRun& run) {
    std::vector<Curve> curves;
    for (const engine::ChannelInfo& channel : run.reader().channels()) {
        const Shown how = shown(channel.name, channel.unit);
        for (Curve& curve : run.curves(channel)) {
            for (double& value : curve.values) value *= how.factor;
            curve.unit = how.unit;
            curves.push_back(std::move(curve));
        }
    }
    return curves;
}

}  // namespace

std::vector<double> Stretches::times(const std::vector<double>& all) const {
    if (count == 0) return all;
    std::vector<double> kept;
    for (std::size_t k = 0; k < count; ++k) {
        kept.push_back(all[begin(k)]);
        kept.push_back(all[(begin(k) + begin(k + 1)) / 2]);
    }
    return kept;
}

std::vector<float> Stretches::values(const std::vector<double>& all) const {
    if (count == 0) return {all.begin(), all.end()};
    std::vector<float> kept;
    for (std::size_t k = 0; k < count; ++k) {
        const auto from = all.begin() + static_cast<std::ptrdiff_t>(begin(k)), to = all.begin() + static_cast<std::ptrdiff_t>(begin(k + 1));
        auto [first, second] = finite_extremes(from, to, [](double value) { return value; });
        if (second < first) std::swap(first, second);
        kept.push_back(static_cast<float>(*first));
        kept.push_back(static_cast<float>(*second));
    }
    return kept;
}

nlohmann::json curve_data(const RecordedRun& run, std::size_t max_bytes) {
    const std::vector<Curve> curves = all_curves(run);
    const auto moving = static_cast<std::size_t>(std::count_if(curves.begin(), curves.end(), [](const Curve& c) { return !constant(c); }));
    const std::size_t points = max_bytes / (6 * (moving + 2));  // a float takes 5.3 bytes of base64
    const std::size_t rows = run.times().size();
    const Stretches stretches{rows, rows <= points ? 0 : std::max<std::size_t>(1, points / 2)};
    const std::vector<double> times = stretches.times(run.times());
    nlohmann::json list = nlohmann::json::array();
    for (const Curve& curve : curves) {
        nlohmann::json entry{{"n", curve.name}, {"u", curve.unit}, {"d", curve.description}};
        if (constant(curve))
            entry["c"] = curve.values.front();
        else
            entry["v"] = packed(stretches.values(curve.values));
        list.push_back(std::move(entry));
    }
    return {{"label", run.path()}, {"rows", rows}, {"shown", times.size()}, {"t", packed(times)}, {"curves", std::move(list)}};
}

nlohmann::json motion_data(const ChainMotion& motion) {
    nlohmann::json data{
        {"pins", motion.pins},       {"recorded", motion.recorded}, {"t", packed(motion.times)},          {"x", quantised(motion.x)},
        {"y", quantised(motion.y)},  {"z", quantised(motion.z)},    {"distance", motion.centre_distance}, {"length", motion.pin_length},
        {"width", motion.pin_width}, {"flank", motion.flank},       {"innermost", motion.innermost},      {"outermost", motion.outermost},
        {"span", motion.plate_span}, {"plates", motion.plates},     {"pulleys", motion.pulleys}};
    data["colours"] = nlohmann::json::array();
    const auto add = [&](const char* name, const char* unit, const std::vector<float>& values) {
        if (!values.empty()) data["colours"].push_back({{"n", name}, {"u", unit}, {"v", quantised(values)}});
    };
    add("tip force", "N", motion.force);
    add("tension", "N", motion.tension);
    if (motion.pulleys) {
        const Shown how = shown("slip", "1");
        std::vector<float> slip = motion.slip;
        for (float& value : slip) value *= static_cast<float>(how.factor);
        add("slip", how.unit.c_str(), slip);
    }
    for (const std::size_t shaft : {0U, 1U})
        data["shafts"].push_back({{"angle", packed(motion.angle[shaft])}, {"radius", packed(motion.radius[shaft])}});
    return data;
}

}  // namespace cvtflow::tools
