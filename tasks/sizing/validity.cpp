#include "tasks/sizing/sizing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "model/law/friction.hpp"

namespace cvtflow::tasks {

namespace {

using model::Parameters;

constexpr double unlimited = std::numeric_limits<double>::infinity();

double load_share(const Parameters&, const SizedPoint& at) { return at.limit > 0.0 ? std::abs(at.load) / at.limit : 0.0; }

/// Pins on the shorter arc of contact.
double carrying_pins(const Parameters& p, const SizedPoint& at) {
    const auto [low, high] = std::minmax(at.radius[0], at.radius[1]);
    const double arc = low * (std::numbers::pi - 2.0 * std::asin(std::min(1.0, (high - low) / p.pulley.centre_distance)));
    return arc * p.chain.pins / chain_length(p.chain);
}

/// A quantity of an instant, and where it was checked.
struct CheckedRange {
    const char *name, *unit;
    double factor;  ///< from SI to the unit
    double (*value)(const Parameters& p, const SizedPoint& at);
    double low, high;  ///< in the unit
    bool rigid;        ///< only of the level `rigid`
    bool always;       ///< only if every instant is outside
    const char* beyond;
};

constexpr const char* unmeasured = "errors of levels and steps were not measured there";
constexpr CheckedRange ranges[] = {
    {"ratio", "", 1.0, [](const Parameters&, const SizedPoint& at) { return at.ratio; }, 0.45, 2.3, false, false, unmeasured},
    {"pins on the shorter arc", "", 1.0, carrying_pins, 10.4, unlimited, false, false, "with few pins shifting is up to twice too slow"},
    {"speed of shaft 1", " rpm", 30.0 / std::numbers::pi, [](const Parameters&, const SizedPoint& at) { return std::abs(at.speed); }, 700.0,
     5000.0, false, false, unmeasured},
    {"S_2", " kN", 1e-3, [](const Parameters&, const SizedPoint& at) { return at.clamping[1]; }, 8.0, 40.0, true, false,
     "the distance of `rigid` from `fine` was not measured there"},
    {"load / torque limit", " %", 100.0, load_share, -unlimited, 85.0, false, false, "slip is known to 1 to 3 %, near 95 % to 11 %"},
    {"load / torque limit", " %", 100.0, load_share, 35.0, unlimited, false, true,
     "some points have two steady states, whose losses differ by 9 %"},
    {"load / torque limit", " %", 100.0, load_share, 5.0, unlimited, true, true, "losses of joints are 10 to 50 % too small"}};

/// Whether friction falls with the sliding speed, by more than rounding.
bool friction_falls(const Parameters& p) {
    const auto law = model::tip_law(p, p.oil.temperature);
    double gained = 0.0;
    for (int k = 0; law != nullptr && k < law->by_speed.intervals; ++k) {
        const auto i = static_cast<std::size_t>(k);
        gained = std::min(gained, law->by_speed.linear[i] + law->by_speed.square[i] + law->by_speed.cube[i]);
    }
    return gained < -1e-9;
}

}  // namespace

std::vector<std::string> outside_validity(const Scene& scene, const Sizing& sizing, double automatic_step) {
    const Parameters& p = scene.parameters;
    const bool is_rigid = p.detail.pins == model::PinDetail::rigid;
    std::vector<std::string> sentences;
    for (const CheckedRange& range : ranges) {
        if (range.rigid && !is_rigid) continue;
        double excess = 0.0, worst = 0.0;
        std::size_t outside = 0;
        for (const SizedPoint& at : sizing.instants) {
            const double value = range.factor * range.value(p, at), beyond = std::max(range.low - value, value - range.high);
            outside += beyond > 1e-9 ? 1 : 0;
            if (beyond > std::max(excess, 1e-9)) excess = beyond, worst = value;
        }
        if (outside == 0 || (range.always && outside < sizing.instants.size())) continue;
        const bool below = worst < range.low;
        sentences.push_back(fmt::format("{} {:.4g}{} is {} {:.4g}{}: {}", range.name, worst, range.unit, below ? "below" : "above",
                                        below ? range.low : range.high, range.unit, range.beyond));
    }
    if (const double tilt = p.pulley.attachment_tilt; p.detail.pulleys == model::PulleyDetail::elastic && (tilt < 0.4e6 || tilt > 1e8))
        sentences.push_back(
            fmt::format("pulley.attachment_tilt {:.3g} N*m/rad is outside of 4e+05 to 1e+08, where errors were measured", tilt));
    if (friction_falls(p)) sentences.emplace_back("friction falls with the sliding speed: levels of detail differ by a third in slip");
    if (const double step = scene.run.step.value_or(0.0); step > automatic_step)
        sentences.push_back(fmt::format("run.step {:.3g} us is longer than the automatic one, {:.3g} us, for which errors are known",
                                        1e6 * step, 1e6 * automatic_step));
    return sentences;
}

}  // namespace cvtflow::tasks
