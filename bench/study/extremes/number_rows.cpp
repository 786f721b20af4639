/// Rows on step lengths, on numbers near the ends of what doubles hold, and on both limits of every parameter.

#include <fmt/format.h>

#include <limits>

#include "bench/study/extremes/extreme.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Ends of a run whose step is far too long. Leapfrogs say before they begin if friction is too stiff for the step.
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
    const double turned = pulleys.reference_angle(1e4, 0);
    if (pulleys.size() == 36) {
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
