/// Rows on friction, damping, stiffness, masses, and on the number and length of parts; on step lengths, on numbers near the ends of the
/// range of doubles, and on both limits of every parameter.

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "bench/study/extremes/extremes.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

using Settings = std::vector<std::string>;

/// "key=factor times the default" for each key.
Settings scaled(std::initializer_list<const char*> keys, double factor) {
    Settings settings;
    Scene defaults;
    for (const char* key : keys) {
        const double value = *std::get<double*>(find_parameter(key)->member(defaults));
        settings.push_back(fmt::format("{}={}", key, number_text(value * factor)));
    }
    return settings;
}

Settings all_friction(const char* what, double value) {
    Settings settings;
    for (const char* part : {"plate", "joint", "tip"}) settings.push_back(fmt::format("{}.{}={}", part, what, number_text(value)));
    return settings;
}

Settings stiffer(double factor) {
    return scaled({"chain.young_modulus", "half.bending_travel", "half.bending_height", "plate.stiffness", "plate.bending_stiffness",
                   "plate.torsion_stiffness", "joint.stiffness", "joint.clearance_stiffness", "tip.hertz", "pulley.bearing_radial",
                   "pulley.bearing_axial", "pulley.bearing_tilt", "pulley.attachment_radial", "pulley.attachment_axial",
                   "pulley.attachment_tilt", "pulley.attachment_torsion"},
                  factor);
}

Settings heavier(double factor) {
    return scaled({"half.mass", "plate.mass", "pulley.sheave_mass", "pulley.sheave_polar_inertia", "pulley.sheave_tilt_inertia",
                   "pulley.shaft_mass", "pulley.shaft_polar_inertia", "pulley.shaft_tilt_inertia"},
                  factor);
}

/// A belt of `pins` pins around two equal pulleys with a gap between them.
/// @param pitch [m]
Settings belt(int pins, double pitch) {
    const double length = pitch * pins;
    const double distance = 0.24 * length;
    const double radius = (length - 2.0 * distance) / (2.0 * M_PI);
    return {fmt::format("chain.pins={}", pins),
            fmt::format("pulley.centre_distance={}", distance),
            fmt::format("pulley.arc_position={}", radius),
            fmt::format("pulley.innermost={}", 0.6 * radius),
            fmt::format("pulley.outermost={}", 1.4 * radius),
            fmt::format("chain.pitch=[{}]", pitch)};
}

Settings ring(int pins) {
    return {fmt::format("chain.pins={}", pins), "detail.pulleys=absent", "start.layout=ring", "start.ring_speed=200"};
}

void add_belt_rows(std::vector<Extreme>& rows) {
    for (const int pins : {3, 4, 5, 12, 84, 1000}) {
        const bool few = pins < 12;  // longer links, lest the pulleys be smaller than any that scenes may have
        rows.push_back({"pins",
                        fmt::format("belt of {}{}", pins, few ? ", 45 mm each" : ""),
                        belt(pins, few ? 45e-3 : 8.12e-3),
                        {Ending::right, Ending::refused, Ending::fault},
                        {FaultKind::left_sheave, FaultKind::penetration}});
        rows.back().geometric = true;
        if (pins >= 1000) rows.back().steps = 20;
    }
    rows.push_back({"pins", "belt of 3 on pulleys too near each other", belt(3, 8.12e-3), {Ending::refused}});
    rows.push_back({"pins", "belt of 10,000 on pulleys too far apart", belt(10000, 8.12e-3), {Ending::refused}});
    rows.push_back({"pins", "belt of 10,000, 4 mm each", belt(10000, 4e-3), {Ending::right, Ending::refused}});
    rows.back().settings.insert(rows.back().settings.end(), {"half.width=2e-3", "drive.speed=2"});
    rows.back().geometric = true;
    rows.back().steps = 10;
    rows.back().nightly = true;
}

}  // namespace

void add_friction_rows(std::vector<Extreme>& rows) {
    for (const double v0 : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0}) {
        rows.push_back({"friction", fmt::format("v0 = {:g} m/s", v0), all_friction("saturation_speed", v0)});
        if (v0 < 1e-4) rows.back().bound = 5e-3;  // a kink every few steps: no method has its order
    }
    rows.push_back({"friction", "v0 = 0", all_friction("saturation_speed", 0.0), {Ending::refused}});
    for (const double mu : {0.0, 0.15, 0.3, 1.0, 2.0}) {
        rows.push_back({"friction", fmt::format("mu = {:g}{}", mu, mu > 0.194 ? ", beyond self-locking" : ""),
                        all_friction("friction_coefficient", mu)});
    }
    for (const double d : {1e-6, 1e-3, 1.0})
        rows.push_back({"friction",
                        fmt::format("smoothed law, d = {:g} v0", d),
                        {"detail.friction=smoothed", fmt::format("detail.smoothing={}", number_text(d))}});
    rows.push_back({"friction", "stick and slip as phases", {"detail.stick_slip=true"}});
    for (const double zeta : {0.0, 1.0, 10.0}) {
        rows.push_back({"damping",
                        fmt::format("zeta = {:g}", zeta),
                        {fmt::format("chain.damping_ratio={:g}", zeta), fmt::format("pulley.damping_ratio={:g}", zeta)}});
    }
    rows.push_back({"damping", "no damping of the cylinder", {"pulley.cylinder_damping=0"}});
    for (const double factor : {1e-3, 1e-1, 1e1, 1e3}) {
        rows.push_back({"stiffness",
                        fmt::format("all stiffnesses x {:g}", factor),
                        stiffer(factor),
                        right_or_fault,
                        {FaultKind::penetration, FaultKind::left_sheave}});
        rows.push_back({"masses",
                        fmt::format("all masses x {:g}", factor),
                        heavier(factor),
                        right_or_fault,
                        {FaultKind::penetration, FaultKind::left_sheave}});
    }
}

namespace {

void add_pitch_rows(std::vector<Extreme>& rows) {
    const auto pitches = [&](const std::string& name, const std::string& list, std::vector<Ending> allowed) {
        rows.push_back({"pitch", name, {"chain.pitch=" + list}, std::move(allowed)});
        rows.back().geometric = true;
        rows.back().faults = {FaultKind::left_sheave, FaultKind::penetration};
    };
    for (const char* pitch : {"0.001", "0.05"}) {
        rows.push_back({"pitch", fmt::format("free ring, all at the limit of {} m", pitch), ring(24)});
        rows.back().settings.insert(rows.back().settings.end(), {fmt::format("chain.pitch=[{}]", pitch), "half.width=5e-4"});
        pitches(fmt::format("all at the limit of {} m, which do not close around these pulleys", pitch), fmt::format("[{}]", pitch),
                {Ending::refused});
    }
    pitches("2.7 and 13.54 mm by turns", "[2.7e-3, 13.54e-3]", right_or_fault);
    pitches("one link twice as long",
            "[16.24e-3, 7.767e-3, 7.767e-3, 7.767e-3, 7.767e-3, 7.767e-3, 7.767e-3, 7.767e-3, 7.767e-3, 7.767e-3, 7.767e-3, 7.767e-3, "
            "7.767e-3, 7.767e-3, 7.767e-3, 7.767e-3, 7.767e-3, 7.767e-3, 7.767e-3, 7.767e-3, 7.767e-3, 7.767e-3, 7.767e-3, 7.767e-3]",
            right_or_fault);
    pitches("longer list than links",
            "[8e-3, 8e-3, 8e-3, 8e-3, 8e-3, 8e-3, 8e-3, 8e-3, 8e-3, 8e-3, 8e-3, 8e-3, 8e-3, 8e-3, 8e-3, 8e-3, 8e-3, 8e-3, 8e-3, 8e-3, "
            "8e-3, 8e-3, 8e-3, 8e-3, 8e-3]",
            {Ending::refused});
}

}  // namespace

void add_size_rows(std::vector<Extreme>& rows) {
    for (const int pins : {3, 4, 5, 12, 84, 1000}) {
        rows.push_back({"pins", fmt::format("free ring of {}", pins), ring(pins)});
        if (pins >= 1000) rows.back().steps = 20;
        rows.back().allowed = {Ending::right, Ending::refused};
    }
    rows.push_back({"pins", "free ring of 10,000", ring(10000)});
    rows.back().settings.back() = "start.ring_speed=2";
    rows.back().steps = 10;
    rows.back().nightly = true;
    rows.push_back({"pins", "free ring of 10,000 at 2.6 km/s, which bursts", ring(10000), {Ending::refused}});
    rows.back().nightly = true;
    add_belt_rows(rows);
    rows.push_back({"pins", "2 pins", ring(2), {Ending::refused}});
    add_pitch_rows(rows);
    for (const int plates : {1, 2, 64})
        rows.push_back(
            {"plates", fmt::format("{} per link", plates), {fmt::format("plate.count={}", plates), "detail.plates=each"}, right_or_fault});
    for (const int points : {1, 2, 4, 8, 16})
        rows.push_back({"joints", fmt::format("{} points", points), {fmt::format("detail.joint_points={}", points)}});
    rows.push_back({"joints", "Palmgren's law", {"joint.law=palmgren"}});
}

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Ends of a run whose step is far too long. Leapfrogs report before they begin if friction is too stiff for the step.
const std::vector<FaultKind> diverged{FaultKind::non_finite, FaultKind::penetration, FaultKind::left_sheave, FaultKind::blow_up,
                                      FaultKind::too_stiff};
/// Ends of a run from such a state.
const std::vector<FaultKind> unsound{FaultKind::non_finite, FaultKind::penetration, FaultKind::left_sheave, FaultKind::blow_up};

void put(const Simulation& simulation, IntegrationState& start, double value) {
    const model::ChainLayout& at = simulation.workspace().layout();
    start.state[static_cast<std::size_t>(at.link_begin(3) + at.link_size())] = value;  // a velocity of link 3
}
void put_nan(const Simulation& simulation, double, IntegrationState& start) {
    put(simulation, start, std::numeric_limits<double>::quiet_NaN());
}
void put_infinity(const Simulation& simulation, double, IntegrationState& start) { put(simulation, start, infinity); }
void put_huge(const Simulation& simulation, double, IntegrationState& start) { put(simulation, start, 1e300); }
/// Finite, its square is not.
void put_half_of_huge(const Simulation& simulation, double, IntegrationState& start) { put(simulation, start, 1e154); }
void put_sound(const Simulation& simulation, double, IntegrationState& start) { put(simulation, start, 2e4); }
/// Every zero becomes the smallest denormal, as mistuned hosts leave them behind.
void put_denormals(const Simulation&, double, IntegrationState& start) {
    for (double& unknown : start.state) unknown = unknown == 0.0 ? std::numeric_limits<double>::denorm_min() : unknown;
}
/// Shaft 1 has turned as far as its governor wants by then.
void put_late(const Simulation& simulation, double, IntegrationState& start) {
    const model::PulleyModel& pulleys = simulation.workspace().variator.pulleys();
    const std::size_t begin = static_cast<std::size_t>(simulation.workspace().layout().pulley_begin());
    const double turned = pulleys.torques().reference_angle(1e4, 0);
    if (pulleys.coordinates().size() == 36) {
        for (const int body : {0, model::sheave_body(0, 0), model::sheave_body(0, 1)})
            start.state[begin + static_cast<std::size_t>(model::body_freedom(body, 5))] += turned;
    } else {
        start.state[begin] += turned;
    }
    start.time = 1e4;
}
void put_early(const Simulation&, double, IntegrationState& start) { start.time = std::numeric_limits<double>::denorm_min(); }
void put_very_late(const Simulation&, double, IntegrationState& start) { start.time = 1e300; }
void put_last(const Simulation&, double, IntegrationState& start) { start.time = infinity; }
void put_never(const Simulation&, double, IntegrationState& start) { start.time = std::numeric_limits<double>::quiet_NaN(); }

}  // namespace

void add_step_rows(std::vector<Extreme>& rows) {
    for (const double step : {1e-12, 1e-10, 1e-9}) {
        rows.push_back({"steps", fmt::format("{:g} s", step), {}});
        rows.back().step = step;
    }
    for (const double step : {3e-7, 1e-6, 3e-6}) {  // in the range of stability limits
        rows.push_back({"steps", fmt::format("{:g} s", step), {}, {Ending::right, Ending::fault, Ending::announced}, diverged});
        rows.back().step = step;
    }
    for (const double step : {1e-5, 1e-4, 1e-3, 1e-2}) {
        rows.push_back({"steps", fmt::format("{:g} s, far beyond stability", step), {}, {Ending::fault}, diverged});
        rows.back().step = step;
    }
}

void add_number_rows(std::vector<Extreme>& rows) {
    const auto row = [&](const char* name, auto prepare, std::vector<Ending> allowed, std::vector<FaultKind> faults, double step = 0.0) {
        rows.push_back({"numbers", name, {}, std::move(allowed), std::move(faults)});
        rows.back().prepare = prepare;
        rows.back().step = step;
    };
    row("a NaN in the state", put_nan, {Ending::fault}, {FaultKind::non_finite});
    row("an infinity in the state", put_infinity, {Ending::fault}, {FaultKind::non_finite});
    row("1e300 m/s", put_huge, {Ending::fault}, unsound);
    row("1e154 m/s, whose square overflows", put_half_of_huge, {Ending::fault}, unsound);
    row("a pin at 20 km/s", put_sound, {Ending::fault}, unsound);
    row("denormals in the place of zeros", put_denormals, {Ending::right}, {});
    row("t = 5e-324 s", put_early, {Ending::right}, {});
    row("t = 1e4 s", put_late, {Ending::right, Ending::fault}, {FaultKind::step_too_short}, 5e-8);
    row("t = 1e4 s with steps of 1e-12 s", put_late, {Ending::fault}, {FaultKind::step_too_short}, 1e-12);
    row("t = 1e300 s", put_very_late, {Ending::fault}, {FaultKind::step_too_short}, 5e-8);
    row("t = infinity", put_last, {Ending::refused}, {}, 5e-8);
    row("t = NaN", put_never, {Ending::refused}, {}, 5e-8);
    for (const char* value : {"1e308", "1e-308", "5e-324", "inf", "nan", "-0.0"}) {
        rows.push_back(
            {"numbers", fmt::format("load.torque = {}", value), {fmt::format("load.torque={}", value)}, {Ending::right, Ending::refused}});
        rows.push_back({"numbers", fmt::format("half.mass = {}", value), {fmt::format("half.mass={}", value)}, {Ending::refused}});
        rows.push_back({"numbers", fmt::format("run.step = {}", value), {fmt::format("run.step={}", value)}, {Ending::refused}});
    }
}

/// Every number of the physics at both ends of its range, alone. Any ending with a name is allowed.
void add_limit_rows(std::vector<Extreme>& rows) {
    for (const Parameter& parameter : parameter_table()) {
        const std::string_view section = parameter.section();
        if (section == "run" || section == "scene" || section == "record") continue;
        if (parameter.kind() != Kind::number && parameter.kind() != Kind::auto_number && parameter.kind() != Kind::time_table &&
            parameter.kind() != Kind::number_list)
            continue;
        for (const double value : {parameter.min, parameter.max}) {
            const std::string text = number_text(value);
            const std::string setting = parameter.kind() == Kind::number_list ? fmt::format("{}=[{}]", parameter.key, text)
                                                                              : fmt::format("{}={}", parameter.key, text);
            rows.push_back(
                {"limits", fmt::format("{} = {}", parameter.key, text), {setting}, {Ending::right, Ending::refused, Ending::fault}});
            rows.back().steps = 100;
            rows.back().bound =
                5e-3;  // the start may put all energy into the stiffest mode, which methods damp by 3e-5 a step at a tenth of stability
            rows.back().swing = 0.02;  // and there h omega = 0.28, a tenth of 2 sqrt 2
        }
    }
}

}  // namespace cvtflow::bench
