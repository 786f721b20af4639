/// Rows on friction, damping, stiffness, masses, and on the number and length of parts.

#include <fmt/format.h>

#include <cmath>

#include "bench/study/extremes/extreme.hpp"
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

}  // namespace cvtflow::bench
