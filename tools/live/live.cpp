/// The core library for a page: what tools/live/worker.js calls. One simulation at a time; texts are valid until the next call.

#include <algorithm>
#include <array>
#include <cmath>
#include <cvtflow/error.hpp>
#include <cvtflow/simulation.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/hash.hpp"
#include "model/parameters/chain_layout.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/scene/units.hpp"

namespace {

using cvtflow::model::End;

/// Numbers of every pin that the page draws.
enum Column { x, y, z, force, tension, slip, columns };

struct Live {
    cvtflow::Simulation simulation;
    cvtflow::model::ChainLayout layout;
    double centre_distance;                      ///< [m]
    std::vector<float> pins = {};                ///< [columns][pins]
    std::map<std::size_t, double> changed = {};  ///< inputs that the page has set
};

std::unique_ptr<Live> live;
std::string text;

/// The text of an error, or an empty one.
template <class Action>
const char* tried(const Action& action) {
    text.clear();
    try {
        action();
    } catch (const std::exception& error) {
        text = error.what();
    }
    return text.c_str();
}

/// Lines as a list.
std::vector<std::string> lines_of(const std::string& lines) {
    std::vector<std::string> list;
    for (std::size_t from = 0; from < lines.size();) {
        const std::size_t end = std::min(lines.find('\n', from), lines.size());
        if (end > from) list.push_back(lines.substr(from, end - from));
        from = end + 1;
    }
    return list;
}

constexpr std::array keys{"clamping.driving", "clamping.driven", "load.torque", "drive.torque",
                          "drive.speed",      "control.ratio",   "load.speed"};

double input_of(cvtflow::Simulation& simulation, std::size_t number) {
    try {
        return simulation.input(static_cast<cvtflow::Input>(number));
    } catch (const cvtflow::Error&) {
        return NAN;
    }
}

std::array<double, 4> tips_of(std::span<const double> tips, const cvtflow::model::ChainLayout& layout, int pin) {
    const auto present = static_cast<std::size_t>(4 * pin), before = static_cast<std::size_t>(4 * layout.previous(pin));
    return {tips[present], tips[present + 1], tips[before + 2], tips[before + 3]};
}

/// Relative to the sheaves between which it runs.
double slip_of(const Live& now, const double* q, const std::array<double, 2>& speed) {
    const auto& at = now.layout;
    const double* v = q + at.link_size();
    const bool second = q[at.x(End::rear, 0)] > 0.5 * now.centre_distance;
    const double dx = q[at.x(End::rear, 0)] - (second ? now.centre_distance : 0.0), dy = q[at.y(End::rear, 0)];
    const double angular = (dx * v[at.y(End::rear, 0)] - dy * v[at.x(End::rear, 0)]) / (dx * dx + dy * dy);
    return speed[second ? 1 : 0] == 0.0 ? 0.0 : 1.0 - angular / speed[second ? 1 : 0];
}

}  // namespace

extern "C" {

/// Begins a simulation. @param settings lines "key=value"
const char* live_open(const char* toml, const char* detail, const char* settings) {
    return tried([&] {
        live.reset();
        cvtflow::Scene scene = cvtflow::Scene::parse(toml).with("start.state=\"\"");
        if (*detail != '\0') scene = scene.with_detail(detail);
        const std::vector<std::string> changes = lines_of(settings);
        scene = scene.with(std::span(changes));
        const cvtflow::tasks::Scene parsed = cvtflow::tasks::parse_scene(scene.text(), "scene.toml");
        live = std::make_unique<Live>(
            Live{cvtflow::Simulation(scene), cvtflow::model::layout_of(parsed.parameters), parsed.parameters.pulley.centre_distance});
    });
}

const char* live_advance(double until) {
    return tried([&] { live->simulation.advance_to(until); });
}
double live_time() { return live->simulation.time(); }
double live_step() { return live->simulation.step_length(); }

/// NaN: the scene has no such input.
double live_input(int number) { return input_of(live->simulation, static_cast<std::size_t>(number)); }
const char* live_set(int number, double value) {
    return tried([&] {
        live->simulation.set_input(static_cast<cvtflow::Input>(number), value);
        live->changed[static_cast<std::size_t>(number)] = value;
    });
}
const char* live_key(int number) { return number < static_cast<int>(keys.size()) ? keys[static_cast<std::size_t>(number)] : ""; }

/// First value of a channel; NaN if the scene does not have it.
double live_channel(const char* name) {
    try {
        return live->simulation.channel(name)[0];
    } catch (const cvtflow::Error&) {
        return NAN;
    }
}

/// [columns][pins]
const float* live_pins() {
    Live& now = *live;
    const int pins = now.layout.links;
    now.pins.assign(static_cast<std::size_t>(columns * pins), 0.0f);
    const std::vector<double> tips = [&] {
        const auto values = now.simulation.channel("tips/axial_force");
        return std::vector<double>(values.begin(), values.end());
    }();
    const auto tensions = now.simulation.channel("links/tension");
    std::vector<double> tension_of(tensions.begin(), tensions.end());
    const std::array<double, 2> speed{live_channel("shaft_1/speed"), live_channel("shaft_2/speed")};
    const auto unknowns = now.simulation.unknowns();
    for (int pin = 0; pin < pins; ++pin) {
        const double* q = unknowns.data() + now.layout.link_begin(pin);
        const auto set = [&](Column column, double value) {
            now.pins[static_cast<std::size_t>(column * pins + pin)] = static_cast<float>(value);
        };
        const auto mine = tips_of(tips, now.layout, pin);
        const double pressed = 0.5 * (std::abs(mine[0] + mine[2]) + std::abs(mine[1] + mine[3]));
        set(x, q[now.layout.x(End::rear, 0)]);
        set(y, q[now.layout.y(End::rear, 0)]);
        set(z, q[now.layout.z(End::rear)]);
        set(force, pressed);
        set(tension, tension_of[static_cast<std::size_t>(pin)]);
        set(slip, pressed > 0.0 ? slip_of(now, q, speed) : 0.0);
    }
    return now.pins.data();
}

/// 0: residual of the energy balance [J], 1: dissipated [J], 2: residual over its tolerance
double live_energy(int which) {
    const auto [residual, dissipated, error_ratio, reliable] = live->simulation.energy();
    return which == 0 ? residual : which == 1 ? dissipated : error_ratio;
}

/// Value of a key as TOML.
const char* live_value(const char* key) {
    text.clear();
    const std::string error = tried([&] { text = live->simulation.scene().value(key); });
    return text.c_str();
}

/// The scene with the inputs that the page has set.
const char* live_scene() {
    text.clear();
    tried([&] {
        std::vector<std::string> changes;
        for (const auto& [number, value] : live->changed)
            changes.push_back(std::string(keys.at(number)) + "=" + cvtflow::tasks::number_text(value));
        text = live->simulation.scene().with(std::span<const std::string>(changes)).text();
    });
    return text.c_str();
}

/// Hash of the state, 16 digits.
const char* live_hash() {
    text = cvtflow::engine::hex(live->simulation.hash());
    return text.c_str();
}
}
